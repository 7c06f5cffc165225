// intaglio bake --all DIR --material M -o DIR -j N
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "command/bake.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/toml.h"
#include "sound/bake/fem/tet_mesh.h"
#include "sound/model_file.h"

extern char** environ;

namespace intaglio::app {

namespace {

namespace fs = std::filesystem;

bool is_mesh(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".obj" || extension == ".stl" || extension == ".gltf" || extension == ".glb";
}

struct Job {
  fs::path mesh, model;
  const char* state = "";  // "baked", "up to date", "failed"
};

Result<std::vector<Job>> jobs_of(const BakeArguments& arguments) {
  std::error_code error;
  std::vector<fs::path> meshes;
  for (auto at = fs::recursive_directory_iterator(arguments.all, error); !error && at != fs::end(at);
       at.increment(error)) {
    if (at->is_regular_file() && is_mesh(at->path())) meshes.push_back(at->path());
  }
  if (error) return fail(arguments.all, error.message(), "--all takes a folder");
  if (meshes.empty()) return fail(arguments.all, "holds no mesh", "meshes end in .obj, .stl, .gltf or .glb");
  std::sort(meshes.begin(), meshes.end());
  std::vector<Job> jobs;
  std::map<fs::path, fs::path> from;
  for (const fs::path& mesh : meshes) {
    const fs::path model =
        (fs::path(arguments.output) / fs::relative(mesh, arguments.all)).replace_extension(".modes");
    const auto [other, is_new] = from.try_emplace(model, mesh);
    if (!is_new)
      return fail(mesh.string(), fmt::format("would be the same model as {}", other->second.string()),
                  "give them different names");
    jobs.push_back({mesh, model});
  }
  return jobs;
}

bool is_up_to_date(const Job& job, const BakeArguments& one, const Material& material) {
  std::error_code error;
  if (!fs::exists(job.model, error)) return false;
  const auto source = source_hash(one, material);
  const auto model = sound::read_model(job.model);
  return source && model && model->source == *source;
}

// This program again, for one mesh; its errors are its own lines on standard error.
pid_t start(const BakeArguments& one) {
  std::vector<std::string> words{"intaglio",   "-q",         "bake", one.mesh,
                                 "--material", one.material, "-o",   one.output};
  const auto add = [&](const char* option, const auto& value) {
    words.insert(words.end(), {option, fmt::format("{}", value)});
  };
  add("--modes", one.modes);
  add("--elements", one.elements);
  add("--max-frequency", one.max_frequency);
  add("--scale", one.scale);
  if (one.element_size > 0) add("--element-size", one.element_size);
  add("--nodes", one.nodes);
  if (one.thickness > 0) add("--thickness", one.thickness);
  add("--shell", one.shell);
  add("--mesher", one.mesher);
  add("--merge", one.merge_db);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = -1;
  return posix_spawn(&child, "/proc/self/exe", nullptr, nullptr, argv.data(), environ) == 0 ? child : -1;
}

void print_summary(const std::vector<Job>& jobs, const BakeArguments& arguments) {
  nlohmann::json list = nlohmann::json::array();
  std::map<std::string, int> count;
  for (const Job& job : jobs) {
    ++count[job.state];
    list.push_back({{"mesh", job.mesh.string()}, {"model", job.model.string()}, {"state", job.state}});
  }
  if (arguments.json) {
    fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print("{} baked, {} up to date, {} failed\n", count["baked"], count["up to date"], count["failed"]);
  }
}

}  // namespace

Result<std::string> source_hash(const BakeArguments& arguments, const Material& material) {
  Hash hash = sound::bake_inputs(material, {"", mode_options(arguments)});
  const auto add_file = [&](const fs::path& path) -> Result<void> {
    const auto bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    hash.add(bytes->size());
    hash.add_bytes(bytes->data(), bytes->size());
    return {};
  };
  if (sound::is_solid_shape(arguments.mesh)) {
    hash.add(std::string_view(arguments.mesh));
  } else {
    std::vector<fs::path> files{arguments.mesh};
    std::error_code error;
    if (files[0].extension() == ".gltf") {
      for (const auto& entry : fs::directory_iterator(fs::absolute(files[0]).parent_path(), error)) {
        if (entry.path().extension() == ".bin") files.push_back(entry.path());
      }
      std::sort(files.begin() + 1, files.end());
    }
    for (const fs::path& file : files) {
      if (auto added = add_file(file); !added) return tl::unexpected(added.error());
    }
  }
  for (const double x : {arguments.scale, arguments.element_size, arguments.thickness, arguments.merge_db})
    hash.add(x);
  hash.add(arguments.elements);
  hash.add(arguments.nodes);
  hash.add(std::string_view(arguments.shell));
  hash.add(std::string_view(arguments.mesher));
  return fmt::format("{:016x}", hash.value());
}

int bake_all(const BakeArguments& arguments, const Common& common) {
  const auto material = named_material(arguments.material);
  if (!material) return report(material.error());
  auto jobs = jobs_of(arguments);
  if (!jobs) return report(jobs.error());
  std::map<pid_t, Job*> running;
  std::size_t done = 0;
  const auto say = [&](Job& job, const char* state) {
    job.state = state;
    ++done;
    if (!common.quiet && !arguments.json)
      fmt::print("[{}/{}] {}: {}\n", done, jobs->size(), job.model.string(), state);
    std::fflush(stdout);
  };
  const auto wait_for_one = [&] {
    int status = 0;
    const pid_t child = wait(&status);
    const auto job = running.find(child);
    if (job == running.end()) return;
    say(*job->second, WIFEXITED(status) && WEXITSTATUS(status) == 0 ? "baked" : "failed");
    running.erase(job);
  };
  for (Job& job : *jobs) {
    BakeArguments one = arguments;
    one.mesh = job.mesh.string();
    one.output = job.model.string();
    if (is_up_to_date(job, one, *material)) {
      say(job, "up to date");
      continue;
    }
    if (std::cmp_greater_equal(running.size(), arguments.jobs)) wait_for_one();
    const pid_t child = start(one);
    if (child < 0) {
      say(job, "failed");
    } else {
      running[child] = &job;
    }
  }
  while (!running.empty()) wait_for_one();
  print_summary(*jobs, arguments);
  return std::any_of(jobs->begin(), jobs->end(),
                     [](const Job& job) { return job.state == std::string("failed"); });
}

}  // namespace intaglio::app
