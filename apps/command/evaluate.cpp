// intaglio evaluate TEXTURE
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <vector>

#include "command/verb.h"
#include "core/file.h"
#include "core/output_files.h"
#include "core/progress.h"
#include "core/text.h"
#include "core/toml.h"
#include "evaluate/evaluation.h"
#include "report/html.h"

namespace intaglio::app {

namespace {

struct EvaluateArguments {
  std::vector<std::string> textures;
  std::string material, fault, html, json, thresholds, all, output;
  double size = 0, depth = -1;  // m; not given
  std::uint64_t seed = 1;
  int runs = 0, jobs = 1;
  bool quick = false, again = false;

  bool is_batch() const { return !all.empty() || textures.size() > 1 || !output.empty(); }
};

Result<evaluate::EvaluateOptions> evaluate_options(const EvaluateArguments& arguments, const Common& common) {
  evaluate::EvaluateOptions options;
  if (arguments.size > 0) options.subject.size = arguments.size;
  if (arguments.depth >= 0) options.subject.depth = arguments.depth;
  options.subject.allowed_memory = common.allowed_memory;
  options.seed = arguments.seed;
  options.quick = arguments.quick;
  if (arguments.runs > 0) options.wanted_runs = arguments.runs;
  if (!arguments.material.empty()) {
    auto material = find_material(arguments.material);
    if (!material) return tl::unexpected(with_where("--material", material.error()));
    options.subject.material = *material;
  }
  if (!arguments.fault.empty())
    if (auto added = scene::add_faults(options.faults, arguments.fault); !added)
      return tl::unexpected(with_where("--fault", added.error()));
  if (!arguments.thresholds.empty()) {
    auto read = evaluate::load_thresholds(arguments.thresholds);
    if (!read) return tl::unexpected(read.error());
    options.thresholds = std::move(*read);
  }
  return options;
}

// Takes surface and cues from `texture` if it is a scene file; options of the command line come first.
Result<void> take_scene(const std::string& texture, const EvaluateArguments& arguments,
                        evaluate::EvaluateOptions& options) {
  options.subject.texture = texture;
  std::error_code ignored;
  if (std::filesystem::path(texture).extension() != ".toml" ||
      !std::filesystem::is_regular_file(texture, ignored))
    return {};
  const auto text = read_text(texture, std::uintmax_t{1} << 20);
  if (!text) return tl::unexpected(text.error());
  // Recipes have no [surface].
  const auto table = parse_toml(*text, texture);
  if (!table || !table->contains("surface")) return {};
  const auto scene = scene::parse_scene(*text, texture);
  if (!scene) return tl::unexpected(scene.error());
  const scene::SurfaceSettings& surface = scene->surface;
  if (surface.base)
    return fail(texture, "has its texture on a curved base", "only flat, square surfaces are evaluated");
  if (arguments.size <= 0 && surface.size.x() != surface.size.y())
    return fail(texture,
                fmt::format("surface.size: {} x {} m is not a square", surface.size.x(), surface.size.y()),
                "give --size, the side of the square to evaluate");
  options.subject.texture = surface.texture;
  if (arguments.size <= 0) options.subject.size = surface.size.x();
  if (arguments.depth < 0) options.subject.depth = surface.depth;
  if (arguments.material.empty()) options.subject.material = surface.material;
  if (arguments.fault.empty()) options.faults = scene->cues;
  return {};
}

void print_table(const evaluate::Evaluation& evaluation) {
  fmt::print("{:28} {:>7} {:>13} {:>7} {:>8} {:>7} {:>9} {:>9} {:>9}\n", "", "mean x", "95 %", "score",
             "ms p95", "missed", "place mm", "force N", "sound dB");
  const auto number = [](double value, int decimals) { return report::format_number(value, decimals); };
  for (const auto& r : evaluation.representations) {
    const evaluate::Measured x = r.mean_jnd();
    fmt::print("{:28} {:>7} {:>6}..{:>5} {:>6}% {:>8} {:>7} {:>9} {:>9} {:>9}\n", r.candidate.title,
               number(x.value, 2), number(x.interval.low, 2), number(x.interval.high, 2),
               number(100 * r.score().value, 0), number(r.percentile_ms(0.95), 1), r.missed(),
               number(r.motion.place_mm.value, 2), number(r.touch.force_n.value, 3),
               number(r.sound.spectrum_db.value, 1));
  }
  const auto& choice = evaluation.recommendation;
  fmt::print("recommended: {}\n", evaluate::candidates()[std::size_t(choice.kind)].title);
  for (const std::string& reason : choice.reasons) fmt::print("  {}\n", reason);
}

int evaluate_one(const EvaluateArguments& arguments, const Common& common) {
  for (const auto& [file, extension, what] : {std::tuple(&arguments.html, ".html", "a page"),
                                              std::tuple(&arguments.json, ".json", "a JSON file")}) {
    if (file->empty()) continue;
    if (auto named = check_extension(*file, extension, what); !named) return report(named.error());
    if (auto writable = check_writable(*file); !writable) return report(writable.error());
  }
  auto options = evaluate_options(arguments, common);
  if (!options) return report(options.error());
  if (auto taken = take_scene(arguments.textures.front(), arguments, *options); !taken)
    return report(taken.error());
  Progress progress("evaluate", common.quiet);
  options->progress = [&](double done, const std::string& what) { progress.update(done, what); };
  const auto evaluation = evaluate::evaluate(*options);
  if (!evaluation) return report(evaluation.error());
  OutputFiles files;
  if (!arguments.html.empty())
    if (auto written = files.write(arguments.html, evaluate::evaluation_html(*evaluation)); !written)
      return report(written.error());
  if (!arguments.json.empty())
    if (auto written = files.write(arguments.json, evaluate::evaluation_json(*evaluation)); !written)
      return report(written.error());
  if (auto committed = files.commit(); !committed) return report(committed.error());
  if (!common.quiet) print_table(*evaluation);
  return 0;
}

// --- Several textures ---

// Folders, images and recipes in a folder, sorted: each is a texture. Other files are not.
bool is_texture(const std::filesystem::directory_entry& entry) {
  constexpr std::array<std::string_view, 6> extensions = {".png", ".jpg", ".jpeg", ".tga", ".exr", ".toml"};
  if (entry.is_directory()) return true;
  std::string extension = entry.path().extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return entry.is_regular_file() &&
         std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

Result<std::vector<std::string>> textures_in(const std::string& folder) {
  std::error_code error;
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (is_texture(entry)) found.push_back(entry.path().string());
  if (error) return fail(folder, error.message(), "give a folder of images, or of folders of images");
  std::sort(found.begin(), found.end());
  if (found.empty())
    return fail(folder, "holds no textures", "give a folder of images, or of folders of images");
  return found;
}

// A result's name: the texture's last part, without extension.
std::string result_name(const std::string& texture) {
  std::filesystem::path path = std::filesystem::path(texture).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  return std::filesystem::is_directory(path) ? path.filename().string() : path.stem().string();
}

// One texture of a batch.
struct BatchItem {
  std::string texture;
  std::filesystem::path json, html;
  std::string line;  // its row in summary.csv; empty until it is measured
  std::optional<Error> error;
};

constexpr std::string_view summary_head =
    "texture,recommended,mean_x_flat,mean_x_normal_paper,mean_x_normal,mean_x_relief_paper,mean_x_relief,"
    "mean_x_mesh_256,mean_x_mesh_512\n";

Result<std::string> summary_line(const BatchItem& item) {
  // Trusted: a result of this command in the user's own folder; any other JSON is refused.
  const auto text = read_text(item.json, std::uintmax_t{1} << 26);
  if (!text) return tl::unexpected(text.error());
  const auto json = nlohmann::json::parse(*text, nullptr, false);
  const auto at = [&](const std::string& path) {
    const nlohmann::json::json_pointer pointer(path);
    return json.is_object() && json.contains(pointer) ? json.at(pointer) : nlohmann::json();
  };
  const nlohmann::json choice = at("/recommendation/representation");
  if (!choice.is_string())
    return fail(item.json.string(), "is no result of evaluate", "remove it, or measure everything --again");
  std::string line = fmt::format("\"{}\",{}", item.texture, choice.get<std::string>());
  for (const evaluate::Candidate& candidate : evaluate::candidates()) {
    const nlohmann::json mean = at(fmt::format("/representations/{}/agreement/jnd/mean", candidate.key));
    line += mean.is_number() ? fmt::format(",{:.4g}", mean.get<double>()) : ",";
  }
  return line + "\n";
}

Result<void> evaluate_item(const evaluate::EvaluateOptions& common, const EvaluateArguments& arguments,
                           BatchItem& item) {
  std::error_code ignored;
  if (arguments.again || !std::filesystem::exists(item.json, ignored)) {
    evaluate::EvaluateOptions options = common;
    if (auto taken = take_scene(item.texture, arguments, options); !taken) return taken;
    const auto evaluation = evaluate::evaluate(options);
    if (!evaluation) return tl::unexpected(evaluation.error());
    OutputFiles files;
    auto written = files.write(item.html, evaluate::evaluation_html(*evaluation));
    if (written) written = files.write(item.json, evaluate::evaluation_json(*evaluation));
    if (written) written = files.commit();
    if (!written) return written;
  }
  auto line = summary_line(item);
  if (!line) return tl::unexpected(line.error());
  item.line = std::move(*line);
  return {};
}

Result<std::vector<BatchItem>> batch_items(const EvaluateArguments& arguments) {
  std::vector<std::string> textures = arguments.textures;
  if (!arguments.all.empty()) {
    auto found = textures_in(arguments.all);
    if (!found) return tl::unexpected(found.error());
    textures.insert(textures.end(), found->begin(), found->end());
  }
  std::map<std::string, std::string> names;
  std::vector<BatchItem> items;
  for (const std::string& texture : textures) {
    const std::string name = result_name(texture);
    if (const auto [at, is_new] = names.try_emplace(name, texture); !is_new)
      return fail(texture, "would have the same result's name as " + at->second,
                  "evaluate them into two folders");
    const std::filesystem::path folder(arguments.output);
    items.push_back({texture, folder / (name + ".json"), folder / (name + ".html"), "", std::nullopt});
  }
  return items;
}

int evaluate_batch(const EvaluateArguments& arguments, const Common& common) {
  const auto options = evaluate_options(arguments, common);
  if (!options) return report(options.error());
  auto items = batch_items(arguments);
  if (!items) return report(items.error());
  if (auto writable = check_writable(std::filesystem::path(arguments.output) / "summary.csv"); !writable)
    return report(writable.error());
  Progress progress("evaluate", common.quiet);
  std::mutex mutex;
  std::size_t next = 0, done = 0;
  const auto work = [&] {
    while (true) {
      std::size_t k = 0;
      {
        const std::lock_guard lock(mutex);
        if (next == items->size()) return;
        k = next++;
      }
      BatchItem& item = (*items)[k];
      if (auto result = evaluate_item(*options, arguments, item); !result) item.error = result.error();
      const std::lock_guard lock(mutex);
      progress.update(double(++done) / double(items->size()), item.texture);
    }
  };
  std::vector<std::thread> threads;
  for (int k = 1; k < arguments.jobs; ++k) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  std::string summary(summary_head);
  int code = 0;
  for (const BatchItem& item : *items) {
    summary += item.line;
    if (item.error) code = report(*item.error);
  }
  if (auto written = write_file(std::filesystem::path(arguments.output) / "summary.csv", summary); !written)
    return report(written.error());
  if (!common.quiet) fmt::print("{}", summary);
  return code;
}

int run_evaluate(const EvaluateArguments& arguments, const Common& common) {
  if (arguments.textures.empty() && arguments.all.empty())
    return report({"evaluate", "has no texture", "name one, such as brick, or give --all FOLDER"});
  if (!arguments.is_batch()) return evaluate_one(arguments, common);
  if (arguments.output.empty())
    return report({"evaluate", "several textures need a folder for their results", "give -o FOLDER"});
  if (!arguments.html.empty() || !arguments.json.empty())
    return report(
        {"evaluate", "with -o every texture has its page and JSON there", "leave out --html and --json"});
  return evaluate_batch(arguments, common);
}

}  // namespace

void add_evaluate(CLI::App& app, Common& common) {
  CLI::App* verb = app.add_subcommand(
      "evaluate", "Measure how well what is seen, felt and heard of a texture agrees, and what it costs");
  auto options = std::make_shared<EvaluateArguments>();
  verb->add_option(
      "TEXTURE", options->textures,
      "Images, folders of images, built-in names (brick; docs/materials.md), recipes or scenes (.toml)");
  verb->add_option("--size", options->size, "Side of the surface, m  [1]")->check(CLI::Range(0.05, 20.0));
  verb->add_option("--depth", options->depth, "Depth of the relief, m; default: as the texture implies")
      ->check(CLI::Range(0.0, 1.0));
  verb->add_option("--material", options->material, "Material of the surface; default: the texture's own");
  verb->add_option("--seed", options->seed, "Seed of the strokes and rolls  [1]");
  verb->add_flag("--quick", options->quick, "4 strokes and rolls instead of 20, smaller pictures");
  verb->add_option("--runs", options->runs,
                   "Strokes and rolls; more narrow the intervals  [20; 4 with --quick]")
      ->check(CLI::Range(1, 1000));
  verb->add_option(
      "--fault", options->fault,
      "Faults, such as sound-delay=60ms,touch-shift=10mm,picture=pebbles: what would people notice?");
  verb->add_option("--thresholds", options->thresholds,
                   "Thresholds of your own (TOML) instead of the literature's");
  verb->add_option("--html", options->html, "Write a page");
  verb->add_option("--json", options->json, "Write all numbers as JSON");
  verb->add_option("-o,--output", options->output,
                   "Folder for a page and a JSON of each texture and summary.csv; done ones are kept");
  verb->add_option("--all", options->all, "Every image and folder in this folder is a texture");
  verb->add_option("-j,--jobs", options->jobs, "Textures at a time  [1]")->check(CLI::Range(1, 256));
  verb->add_flag("--again", options->again, "Measure what is done already, too");
  verb->footer(
      "Examples:\n  intaglio evaluate brick --quick --html out/brick.html\n  intaglio evaluate my_wall/ --size 2 --json "
      "out/wall.json\n  intaglio evaluate brick --quick --fault sound-delay=60ms");
  verb->callback([options, &common] { common.exit_code = run_evaluate(*options, common); });
}

}  // namespace intaglio::app
