// intaglio inspect FILE|DIR, intaglio import FILE|DIR -o DIR
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "command/verb.h"
#include "core/file.h"
#include "report/inspect_page.h"
#include "surface/import.h"

namespace intaglio::app {

namespace {

struct InspectArguments {
  std::string path, output, html, green, polarity;
  bool json = false, raw = false, clamp = false;
  double depth = -1;
  int size = surface::ImportOptions().generated_size;
};

surface::ImportOptions import_options(const InspectArguments& options, const Common& common) {
  surface::ImportOptions out;
  out.allowed_memory = common.allowed_memory;
  if (!options.green.empty()) out.green = parse_green(options.green);
  if (!options.polarity.empty()) out.polarity = parse_polarity(options.polarity);
  if (options.depth >= 0) out.depth_fraction = options.depth;
  out.generated_size = options.size;
  if (options.raw) out.mode = surface::ImportMode::raw;
  if (options.clamp) out.edge = surface::Edge::clamp;
  return out;
}

void add_import_options(CLI::App& verb, InspectArguments& options) {
  verb.add_option("TEXTURE", options.path,
                  "An image (normal, height or RGBA; PNG, JPEG, TGA, EXR), a folder of them, a built-in name "
                  "(pebbles; docs/materials.md) or a recipe (.toml)")
      ->required();
  verb.add_option("--size", options.size, "Side of a generated texture, texels")->check(CLI::Range(64, 8192));
  verb.add_option("--green", options.green, "Sign of the green channel; default: detected")
      ->check(CLI::IsMember({"+Y", "-Y"}));
  verb.add_option("--polarity", options.polarity, "Meaning of white; default: detected")
      ->check(CLI::IsMember({"height", "depth"}));
  verb.add_option("--depth", options.depth, "Full depth / side of the tile; default: as the normals imply")
      ->check(CLI::Range(0.0, 10.0));
  verb.add_flag("--raw", options.raw, "Use the maps unchanged: no fusion, no implied height");
  verb.add_flag("--no-tile", options.clamp, "Not tileable: opposite borders need not match");
}

void print_summary(const surface::Inspection& i) {
  fmt::print("{} x {} texels\n", i.width, i.height);
  for (const std::string& note : i.notes) fmt::print("  {}\n", note);
  for (const std::string& warning : i.warnings) fmt::print("  warning: {}\n", warning);
  fmt::print("  full depth {:.2f} % of the side, rms slope {:.3f}, {:.2f} % steep, {:.2f} % near-vertical\n",
             100 * i.depth_fraction, i.rms_slope, 100 * i.steep_fraction, 100 * i.near_vertical_fraction);
  fmt::print("  recommended representation: {} ({})\n", i.representation, i.reason);
}

int run_inspect(const InspectArguments& options, const Common& common) {
  if (!options.html.empty()) {
    if (auto named = check_extension(options.html, ".html", "a page"); !named) return report(named.error());
    if (auto writable = check_writable(options.html); !writable) return report(writable.error());
  }
  const auto inspection = surface::inspect(options.path, import_options(options, common));
  if (!inspection) return report(inspection.error());
  if (!options.html.empty()) {
    const auto title =
        "Texture: " + std::filesystem::path(options.path).lexically_normal().filename().string();
    if (auto written = write_file(options.html, report::inspection_html(*inspection, title)); !written)
      return report(written.error());
  }
  if (options.json) {
    fmt::print("{}", report::inspection_json(*inspection));
  } else if (!common.quiet) {
    print_summary(*inspection);
  }
  return 0;
}

int run_import(const InspectArguments& options, const Common& common) {
  const auto imported = surface::import_texture(options.path, import_options(options, common));
  if (!imported) return report(imported.error());
  if (auto written = surface::write_texture_files(*imported, options.output); !written)
    return report(written.error());
  if (!common.quiet) {
    for (const std::string& note : imported->notes) fmt::print("{}\n", note);
    for (const std::string& warning : imported->warnings) fmt::print("warning: {}\n", warning);
    fmt::print("{}: relief.png, color.png; use it with --surface {}\n", options.output, options.output);
  }
  return 0;
}

}  // namespace

void add_inspect(CLI::App& app, Common& common) {
  CLI::App* verb =
      app.add_subcommand("inspect", "Report a texture's conventions, depth, slopes and best representation");
  auto options = std::make_shared<InspectArguments>();
  add_import_options(*verb, *options);
  verb->add_flag("--json", options->json, "Print everything as one JSON object");
  verb->add_option("--html", options->html, "Also write a page with pictures");
  verb->footer("Example:\n  intaglio inspect my_wall/ --html out/my_wall.html");
  verb->callback([options, &common] { common.exit_code = run_inspect(*options, common); });
}

void add_import(CLI::App& app, Common& common) {
  CLI::App* verb = app.add_subcommand(
      "import", "Convert images to one consistent surface: 16-bit normals and depth, +Y, 0 = top");
  auto options = std::make_shared<InspectArguments>();
  add_import_options(*verb, *options);
  verb->add_option("-o,--output", options->output, "Folder for relief.png and color.png")->required();
  verb->footer(
      "Example:\n  intaglio import my_wall/ -o textures/wall\n  intaglio render scenes/brick.toml --surface "
      "textures/wall -o out/wall.mp4");
  verb->callback([options, &common] { common.exit_code = run_import(*options, common); });
}

}  // namespace intaglio::app
