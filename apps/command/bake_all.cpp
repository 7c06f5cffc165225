// intaglio bake --all DIR --material M -o DIR -j N
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <list>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "command/bake.h"
#include "command/stop.h"
#include "core/file.h"
#include "core/hash.h"
#include "core/process.h"
#include "core/text.h"
#include "core/toml.h"
#include "mesh/mesh_file.h"
#include "sound/bake/fem/tet_mesh.h"
#include "sound/model_file.h"

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
  std::string state = {};  // "baked", "up to date", "failed"; "stopped" or empty where the command was
};

Result<std::vector<Job>> list_jobs(const BakeArguments& options) {
  std::error_code error;
  std::vector<fs::path> meshes;
  for (auto at = fs::recursive_directory_iterator(options.all, error); !error && at != fs::end(at);
       at.increment(error)) {
    if (at->is_regular_file() && is_mesh(at->path())) meshes.push_back(at->path());
  }
  if (error) return fail(options.all, error.message(), "--all takes a folder");
  if (meshes.empty()) return fail(options.all, "holds no mesh", "meshes end in .obj, .stl, .gltf or .glb");
  std::sort(meshes.begin(), meshes.end());
  std::vector<Job> jobs;
  std::map<fs::path, fs::path> from;
  for (const fs::path& mesh : meshes) {
    const fs::path model =
        (fs::path(options.output) / fs::relative(mesh, options.all)).replace_extension(".modes");
    const auto [other, is_new] = from.try_emplace(model, mesh);
    if (!is_new)
      return fail(mesh.string(), fmt::format("would overwrite the model of {}", other->second.string()),
                  "give them different names");
    jobs.push_back({mesh, model});
  }
  return jobs;
}

bool is_up_to_date(const Job& job, const BakeArguments& job_options, const Material& material) {
  std::error_code error;
  if (!fs::exists(job.model, error)) return false;
  const auto source = source_hash(job_options, material);
  const auto model = sound::read_model(job.model);
  return source && model && model->identity == *source;
}

// Spawns this executable for one mesh; it reports its own errors.
Result<Process> spawn_bake(const BakeArguments& job_options) {
  std::vector<std::string> argv_strings{
      "-q", "bake", job_options.mesh, "--material", job_options.material, "-o", job_options.output};
  const auto add = [&](const char* option, const auto& value) {
    argv_strings.insert(argv_strings.end(), {option, fmt::format("{}", value)});
  };
  add("--modes", job_options.modes);
  add("--elements", job_options.elements);
  add("--max-frequency", job_options.max_frequency);
  add("--scale", job_options.scale);
  if (job_options.element_size > 0) add("--element-size", job_options.element_size);
  add("--nodes", job_options.nodes);
  if (job_options.thickness > 0) add("--thickness", job_options.thickness);
  add("--shell", job_options.shell);
  add("--mesher", job_options.mesher);
  add("--merge", job_options.merge_db);
  add("--allow-memory", fmt::format("{}M", double(job_options.allowed_memory) / 1e6));
  SpawnOptions spawn_options;
  spawn_options.share_output = true;
  return Process::start("/proc/self/exe", argv_strings, spawn_options);
}

void print_summary(const std::vector<Job>& jobs, const BakeArguments& options) {
  nlohmann::json list = nlohmann::json::array();
  std::map<std::string, int> count;
  for (const Job& job : jobs) {
    ++count[job.state];
    list.push_back({{"mesh", job.mesh.string()}, {"model", job.model.string()}, {"state", job.state}});
  }
  if (options.json) {
    print_json(list);
  } else {
    fmt::print("{} baked, {} up to date, {} failed\n", count["baked"], count["up to date"], count["failed"]);
  }
}

// The bakes of all jobs, some at once.
class Bakes {
 public:
  Bakes(std::vector<Job>& jobs, bool says) : jobs_(jobs), says_(says) {}

  // Until all have ended or the command is interrupted.
  void run(const BakeArguments& options, const Material& material) {
    for (Job& job : jobs_) {
      BakeArguments job_options = options;
      job_options.mesh = job.mesh.string();
      job_options.output = job.model.string();
      if (interrupted) return;
      if (is_up_to_date(job, job_options, material)) {
        finish(job, "up to date");
        continue;
      }
      wait([&] { return interrupted || std::cmp_less(running_.size(), options.jobs); });
      if (interrupted) return;
      if (auto child = spawn_bake(job_options)) {
        running_.emplace_back(std::move(*child), &job);
      } else {
        report(child.error());
        finish(job, "failed");
      }
    }
    wait([&] { return interrupted || running_.empty(); });
  }

  // Each child removes its temporaries.
  void stop() {
    for (const auto& [child, job] : running_) child.terminate();
    wait([&] { return running_.empty(); });
  }

 private:
  template <class Condition>
  void wait(const Condition& is_over) {
    while (!is_over()) {
      for (auto at = running_.begin(); at != running_.end();) {
        const auto ended = at->first.poll();
        if (ended) finish(*at->second, *ended ? "baked" : interrupted ? "stopped" : "failed");
        at = ended ? running_.erase(at) : std::next(at);
      }
      if (!is_over()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  void finish(Job& job, const char* state) {
    job.state = state;
    ++done_;
    if (says_ && !interrupted) fmt::print("[{}/{}] {}: {}\n", done_, jobs_.size(), job.model.string(), state);
    std::fflush(stdout);
  }

  std::vector<Job>& jobs_;
  bool says_;
  std::list<std::pair<Process, Job*>> running_;
  std::size_t done_ = 0;
};

}  // namespace

Result<std::string> source_hash(const BakeArguments& options, const Material& material) {
  Hash hash = sound::bake_hash(material, {"", mode_options(options)});
  const auto add_file = [&](const fs::path& path) -> Result<void> {
    const auto bytes = read_file(path, surface::max_mesh_file_bytes);  // Not parsed: hashed
    if (!bytes) return tl::unexpected(bytes.error());
    hash.add(bytes->size());
    hash.add_bytes(bytes->data(), bytes->size());
    return {};
  };
  if (sound::is_solid_shape(options.mesh)) {
    hash.add(std::string_view(options.mesh));
  } else {
    std::vector<fs::path> files{options.mesh};
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
  for (const double x : {options.scale, options.element_size, options.thickness, options.merge_db})
    hash.add(x);
  hash.add(options.elements);
  hash.add(options.nodes);
  hash.add(std::string_view(options.shell));
  hash.add(std::string_view(options.mesher));
  return fmt::format("{:016x}", hash.value());
}

int bake_all(const BakeArguments& options, const Common& common) {
  const auto material = load_material(options.material);
  if (!material) return report(material.error());
  auto jobs = list_jobs(options);
  if (!jobs) return report(jobs.error());
  end_gracefully();
  Bakes bakes(*jobs, !common.quiet && !options.json);
  bakes.run(options, *material);
  if (interrupted) {
    bakes.stop();
    const auto whole = std::count_if(jobs->begin(), jobs->end(), [](const Job& job) {
      return job.state == "baked" || job.state == "up to date";
    });
    print_error(fmt::format("intaglio: interrupted: {} of {} models are baked; run it again for the others\n",
                            whole, jobs->size()));
    return interrupted_code();
  }
  print_summary(*jobs, options);
  return std::any_of(jobs->begin(), jobs->end(), [](const Job& job) { return job.state == "failed"; });
}

}  // namespace intaglio::app
