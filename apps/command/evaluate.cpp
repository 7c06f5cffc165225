// intaglio evaluate TEXTURE
#include <fmt/format.h>

#include <memory>
#include <string>

#include "command/verb.h"
#include "core/file.h"
#include "core/output_files.h"
#include "core/progress.h"
#include "core/text.h"
#include "evaluate/evaluation.h"

namespace intaglio::app {

namespace {

struct EvaluateArguments {
  std::string texture, material, fault, html, json, thresholds;
  double size = 1, depth = -1;
  std::uint64_t seed = 1;
  int runs = 0;
  bool quick = false;
};

Result<evaluate::EvaluateOptions> evaluate_options(const EvaluateArguments& arguments, const Common& common) {
  evaluate::EvaluateOptions options;
  options.subject.texture = arguments.texture;
  options.subject.size = arguments.size;
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

void print_table(const evaluate::Evaluation& evaluation) {
  fmt::print("{:28} {:>7} {:>13} {:>7} {:>8} {:>7} {:>9} {:>9} {:>9}\n", "", "mean x", "95 %", "score",
             "ms p95", "missed", "place mm", "force N", "sound dB");
  for (const auto& r : evaluation.representations) {
    const evaluate::Measured x = r.mean_jnd();
    fmt::print("{:28} {:7.2f} {:6.2f}..{:5.2f} {:6.0f}% {:8.1f} {:7} {:9.2f} {:9.3f} {:9.1f}\n",
               r.candidate.title, x.value, x.interval.low, x.interval.high, 100 * r.score().value,
               r.percentile_ms(0.95), r.missed(), r.motion.place_mm.value, r.touch.force_n.value,
               r.sound.spectrum_db.value);
  }
  const auto& choice = evaluation.recommendation;
  fmt::print("recommended: {}\n", evaluate::candidates()[std::size_t(choice.kind)].title);
  for (const std::string& reason : choice.reasons) fmt::print("  {}\n", reason);
}

int run_evaluate(const EvaluateArguments& arguments, const Common& common) {
  for (const auto& [file, extension, what] : {std::tuple(&arguments.html, ".html", "a page"),
                                              std::tuple(&arguments.json, ".json", "a JSON file")}) {
    if (file->empty()) continue;
    if (auto named = check_extension(*file, extension, what); !named) return report(named.error());
    if (auto writable = check_writable(*file); !writable) return report(writable.error());
  }
  auto options = evaluate_options(arguments, common);
  if (!options) return report(options.error());
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

}  // namespace

void add_evaluate(CLI::App& app, Common& common) {
  CLI::App* verb = app.add_subcommand(
      "evaluate", "Measure how well what is seen, felt and heard of a texture agrees, and what it costs");
  auto options = std::make_shared<EvaluateArguments>();
  verb->add_option(
          "TEXTURE", options->texture,
          "An image, a folder of images, a built-in name (brick; docs/materials.md) or a recipe (.toml)")
      ->required();
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
  verb->footer(
      "Examples:\n  intaglio evaluate brick --quick --html out/brick.html\n  intaglio evaluate my_wall/ --size 2 --json "
      "out/wall.json\n  intaglio evaluate brick --quick --fault sound-delay=60ms");
  verb->callback([options, &common] { common.exit_code = run_evaluate(*options, common); });
}

}  // namespace intaglio::app
