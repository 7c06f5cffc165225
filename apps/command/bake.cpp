// intaglio bake MESH --material M -o MODEL

#include "command/bake.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <set>

#include "command/verb.h"
#include "core/file.h"
#include "core/progress.h"
#include "core/toml.h"
#include "mesh/mesh_file.h"
#include "scene/surfaces.h"
#include "scene/voices/voices.h"
#include "sound/bake/bake.h"
#include "sound/bake/fem/fill_surface.h"
#include "sound/bake/fem/mesher.h"
#include "sound/bake/fem/tet_mesh.h"
#include "sound/bake/merge_modes.h"
#include "sound/model_file.h"

namespace intaglio::app {

namespace {

double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// Wall and processor seconds since construction.
struct Stopwatch {
  double wall = seconds(CLOCK_MONOTONIC), cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
  double wall_s() const { return seconds(CLOCK_MONOTONIC) - wall; }
  double cpu_s() const { return seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu; }
};

// The elements of a body.
struct Body {
  sound::FilledSurface filled;
  std::size_t surface_vertices = 0;
  std::optional<sound::BodySurface> springs = {};  // the surface itself, for a spring-mass shell
};

struct Costs {
  double mesh_s = 0, modes_s = 0, total_s = 0, cpu_s = 0;
};

std::size_t surface_nodes(const sound::TetMesh& mesh) {
  std::set<int> nodes;
  for (const sound::Triangle6& face : mesh.boundary) nodes.insert(face.begin(), face.end());
  return nodes.size();
}

// Checks that the longest side, m, is plausible.
Result<void> check_size(double side, const BakeArguments& options) {
  constexpr double smallest = 1e-4, largest = 1000;  // m
  if (!(side >= smallest && side <= largest))
    return fail(
        options.mesh, fmt::format("is {:.3g} m long", side),
        fmt::format("a body must be between {} m and {} m long; --scale gives the metres per file unit",
                    smallest, largest));
  if (options.thickness > side)
    return fail(
        options.mesh,
        fmt::format("is {:.3g} m long, less than the shell's thickness of {:g} m", side, options.thickness),
        "give a smaller --thickness, in metres");
  return {};
}

Result<Body> make_elements(const BakeArguments& options, const Material& material,
                           const sound::ModeOptions& modes) {
  const auto size_for = [&](double volume, double area) {
    return options.element_size > 0 ? options.element_size
                                    : sound::element_size(volume, area, material, modes);
  };
  if (sound::is_solid_shape(options.mesh)) {
    const auto shape = sound::solid_shape(options.mesh);
    if (!shape) return tl::unexpected(shape.error());
    const double size = size_for(shape->volume(), shape->area());
    Body body{{shape->mesh(size, options.elements), size, {}, "structured"}};
    body.surface_vertices = surface_nodes(body.filled.mesh);
    return body;
  }
  auto mesh = surface::read_mesh(options.mesh, {surface::MeshUse::shape, options.allowed_memory});
  if (!mesh) return tl::unexpected(mesh.error());
  std::erase_if(mesh->notes, [](const std::string& note) {
    return note.find("normals were missing") != std::string::npos;
  });
  Eigen::AlignedBox3d bounds;
  for (Vec3& position : mesh->positions) bounds.extend(position *= options.scale);
  if (auto sane = check_size(bounds.sizes().maxCoeff(), options); !sane) return tl::unexpected(sane.error());
  const auto surface = sound::body_surface(*mesh, options.mesh, options.thickness);
  if (!surface) return tl::unexpected(surface.error());
  if (options.shell == "springs") return Body{{{}, 0, surface->notes}, surface->points.size(), *surface};
  sound::FillOptions fill{size_for(surface->volume, surface->area), options.elements};
  const bool keeps_edges = options.thickness == 0 && surface->is_closed();
  if (keeps_edges && !(options.element_size > 0) && sound::has_skew_edges(*surface, fill.element_size))
    fill.element_size *= sound::skew_edge_size_factor;
  const auto mesher = options.mesher == "netgen"    ? sound::Mesher::netgen
                      : options.mesher == "lattice" ? sound::Mesher::lattice
                                                    : sound::Mesher::automatic;
  auto filled = sound::fill_with(mesher, *surface, fill, {}, options.mesh);
  if (!filled) return tl::unexpected(filled.error());
  return Body{std::move(*filled), surface->points.size(), {}};
}

// Memory of a dense K: three degrees of freedom a surface vertex, in doubles.
double dense_gigabytes(std::size_t vertices) {
  return 8.0 * std::pow(3.0 * double(vertices), 2) / std::pow(1024.0, 3);
}

// The modes before merging.
struct UnmergedModes {
  std::vector<double> frequencies, decay_rates;
};

std::vector<double> in_hertz(const std::vector<double>& angular) {
  std::vector<double> hertz;
  for (const double omega : angular) hertz.push_back(omega / (2 * std::numbers::pi));
  return hertz;
}

nlohmann::json as_json(const UnmergedModes& found, const sound::ModalModel& model, const Body& body,
                       const Costs& costs) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {{"frequencies", found.frequencies},
          {"decay_rates", found.decay_rates},
          {"model_frequencies", in_hertz(model.angular_frequency)},
          {"merge_error_db", model.merge_error_db},
          {"merge_error_rms_db", model.merge_error_rms_db},
          {"residual", model.residual},
          {"material", model.material.name},
          {"mass", model.mass},
          {"area", model.area},
          {"nodes", body.filled.mesh.nodes.size()},
          {"elements", body.filled.mesh.tets.size()},
          {"mesher", body.filled.mesher},
          {"element_size", body.filled.element_size},
          {"surface_points", model.points.size()},
          {"shape_error", model.shape_error},
          {"surface_vertices", body.surface_vertices},
          {"dense_method_gb", dense_gigabytes(body.surface_vertices)},
          {"notes", body.filled.notes},
          {"mesh_seconds", costs.mesh_s},
          {"modes_seconds", costs.modes_s},
          {"seconds", costs.total_s},
          {"cpu_seconds", costs.cpu_s},
          {"peak_memory_mb", double(usage.ru_maxrss) / 1024}};
}

void print_summary(const nlohmann::json& result, const BakeArguments& options) {
  for (const auto& note : result["notes"]) fmt::print("{}: {}\n", options.mesh, note.get<std::string>());
  const auto& f = result["frequencies"];
  fmt::print("{}: {} modes, {:.1f} to {:.1f} Hz, of {} elements ({} nodes); {:.3g} kg; residual {:.1e}\n",
             options.output, f.size(), f.front().get<double>(), f.back().get<double>(),
             result["elements"].get<int>(), result["nodes"].get<int>(), result["mass"].get<double>(),
             result["residual"].get<double>());
  if (const auto kept = result["model_frequencies"].size(); kept < f.size())
    fmt::print("merged to {} perceptually equal modes: bands within {:.2f} dB, root mean square {:.2f} dB\n",
               kept, result["merge_error_db"].get<double>(), result["merge_error_rms_db"].get<double>());
  fmt::print(
      "{:.1f} s ({:.1f} s of them for the mesh), {:.1f} CPU-s, {:.0f} MB (a dense matrix over {} surface "
      "vertices: {:.3g} GB)\n",
      result["seconds"].get<double>(), result["mesh_seconds"].get<double>(),
      result["cpu_seconds"].get<double>(), result["peak_memory_mb"].get<double>(),
      result["surface_vertices"].get<int>(), result["dense_method_gb"].get<double>());
}

int run_bake(const BakeArguments& options, const Common& common) {
  const Stopwatch all;
  const auto material = load_material(options.material);
  if (!material) return report(material.error());
  if (auto named = check_extension(options.output, ".modes", "a model"); !named) return report(named.error());
  if (auto writable = check_writable(options.output); !writable) return report(writable.error());
  if (options.thickness > 0 && sound::is_solid_shape(options.mesh))
    return report(
        {options.mesh, "built-in shapes are solid and take no --thickness", "--thickness is for mesh files"});
  if (options.mesher != "auto" && sound::is_solid_shape(options.mesh))
    return report({options.mesh, "built-in shapes have structured elements and take no --mesher",
                   "--mesher is for mesh files"});
  if (options.scale != 1 && sound::is_solid_shape(options.mesh))
    return report({options.mesh, "built-in shapes are in metres and take no --scale", "give the sizes"});
  if (options.shell == "springs" && !(options.thickness > 0))
    return report({options.mesh, "a spring-mass shell needs a thickness", "give --thickness METRES"});
  const auto source = source_hash(options, *material);
  if (!source) return report(source.error());
  Progress progress("bake", common.quiet);
  sound::ModeOptions modes = mode_options(options);
  progress.update(0.02, "filling the surface");
  const auto body = make_elements(options, *material, modes);
  if (!body) return report(body.error());
  Costs costs;
  costs.mesh_s = all.wall_s();
  progress.update(0.15, fmt::format("{} elements", body->filled.mesh.tets.size()));
  modes.progress = [&](double done) { progress.update(0.3 + 0.65 * done, "modes"); };
  const sound::BakeOptions bake_options{
      std::filesystem::path(options.mesh).stem().string(), modes, {}, *source};
  auto model = body->springs        ? sound::bake_spring_shell(*body->springs, options.thickness, *material,
                                                               bake_options, options.mesh)
               : options.nodes == 4 ? sound::bake_linear(body->filled.mesh, *material, bake_options)
                                    : sound::bake(body->filled.mesh, *material, bake_options);
  if (!model) return report({options.mesh, model.error().message(), ""});
  if (model->modes() == 0) {
    return report(
        {options.mesh, fmt::format("no mode between 20 Hz and {:.0f} Hz", options.max_frequency),
         "try a larger --max-frequency for a small or stiff body; an overdamped body has no modes; a mesh in "
         "millimetres needs --scale 0.001"});
  }
  const UnmergedModes found{in_hertz(model->angular_frequency), model->damping};
  sound::merge_modes(*model, options.merge_db);
  costs.modes_s = all.wall_s() - costs.mesh_s;
  if (auto written = sound::write_model(options.output, *model); !written) return report(written.error());
  progress.update(1, "written");
  costs.total_s = all.wall_s();
  costs.cpu_s = all.cpu_s();
  const nlohmann::json result = as_json(found, *model, *body, costs);
  if (options.json) {
    print_json(result);
  } else if (!common.quiet) {
    print_summary(result, options);
  }
  return 0;
}

// Options of the mesh and of the analysis.
void add_model_options(CLI::App& verb, BakeArguments& options) {
  verb.add_option("--modes", options.modes, "Maximum number of modes")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb.add_option("--max-frequency", options.max_frequency, "Hz; modes above are dropped")
      ->check(CLI::Range(100.0, 1e6))
      ->capture_default_str();
  verb.add_option("--elements", options.elements, "Approximate upper limit on tetrahedra")
      ->check(CLI::Range(100, 1'000'000))
      ->capture_default_str();
  verb.add_option("--element-size", options.element_size,
                  "Element size, metres; default: 1/4 of the shortest wavelength (1/5 for thin bodies)")
      ->check(CLI::Range(1e-5, 10.0));
  verb.add_option("--nodes", options.nodes, "Nodes per element: 10 (quadratic) or 4 (linear; pitch too high)")
      ->check(CLI::IsMember({4, 10}))
      ->capture_default_str();
  verb.add_option("--thickness", options.thickness,
                  "Shell thickness, metres: the mesh is the middle surface of a shell, open or closed")
      ->check(CLI::Range(1e-5, 10.0));
  verb.add_option("--shell", options.shell, "Model of a shell: solid elements, or the paper's springs")
      ->check(CLI::IsMember({"solid", "springs"}))
      ->capture_default_str();
  verb.add_option(
          "--merge", options.merge_db,
          "Merge indistinguishable modes, changing no auditory band by more than this many dB; 0 disables")
      ->check(CLI::Range(0.0, 20.0))
      ->capture_default_str();
  verb.add_option(
          "--mesher", options.mesher,
          "Tetrahedral mesher: lattice (any mesh), netgen (clean closed meshes; keeps sharp edges), or auto")
      ->check(CLI::IsMember({"lattice", "netgen", "auto"}))
      ->capture_default_str();
  verb.add_option("--scale", options.scale, "Metres per file unit")
      ->check(CLI::Range(1e-6, 1e6))
      ->capture_default_str();
}

}  // namespace

void add_bake(CLI::App& app, Common& common) {
  CLI::App* verb = app.add_subcommand("bake", "Compute a body's vibration modes (modal analysis of a mesh)");
  auto options = std::make_shared<BakeArguments>();
  verb->add_option("MESH", options->mesh,
                   "A file (.obj .stl .gltf .glb, metres) or a shape: sphere:r=0.05  box:x=0.3,y=0.01,z=0.2  "
                   "plate:a=0.3,t=0.01  cylinder:r=0.02,h=0.2");
  auto* material =
      verb->add_option("--material", options->material, "A built-in name, or a TOML file (docs/bake.md)");
  verb->add_option("-o,--output", options->output, "The model; with --all or --scene a folder")->required();
  auto* all = verb->add_option("--all", options->all,
                               "Bake every mesh in this folder and below; skips up-to-date models")
                  ->excludes("MESH");
  verb->add_option("--scene", options->scene,
                   "Bake every model that this scene sounds with into the folder -o; scenes look in `models` "
                   "beside them first")
      ->excludes("MESH")
      ->excludes(all)
      ->excludes(material);
  verb->add_option("-j,--jobs", options->jobs, "Parallel bakes, with --all")
      ->check(CLI::Range(1, 1000))
      ->needs(all)
      ->capture_default_str();
  add_model_options(*verb, *options);
  verb->add_flag("--json", options->json,
                 "Print frequencies, decay rates, residual, times and memory as JSON");
  verb->footer(
      "Example:\n  intaglio bake plate:a=0.3,t=0.01 --material ceramic -o out/tile.modes\n  intaglio bake vase.stl "
      "--scale 0.001 --material glass -o out/vase.modes --json\n  intaglio bake --all meshes/ --material glass "
      "-o out/models -j 2\n  intaglio bake --scene my/scene.toml -o my/models");
  verb->callback([options, &common] {
    options->allowed_memory = common.allowed_memory;
    if (options->mesh.empty() && options->all.empty() && options->scene.empty())
      throw CLI::RequiredError("MESH, --all or --scene");
    if (options->material.empty() && options->scene.empty()) throw CLI::RequiredError("--material");
    common.exit_code = !options->scene.empty() ? bake_scene(*options, common)
                       : options->all.empty()  ? run_bake(*options, common)
                                               : bake_all(*options, common);
  });
}

// intaglio bake --scene SCENE -o DIR

int bake_scene(const BakeArguments& options, const Common& common) {
  namespace fs = std::filesystem;
  const auto scene = scene::read_scene(options.scene, common.allowed_memory);
  if (!scene) return report(scene.error());
  const auto surface = scene::make_surface(*scene);
  if (!surface) return report(surface.error());
  std::error_code error;
  fs::create_directories(options.output, error);
  if (error || !fs::is_directory(options.output))
    return report({options.output, "is not a folder and cannot be created", "give -o another name"});
  const auto voices = scene::bake_voices(*scene, *surface, {.cache = options.output, .shipped = ""});
  if (!voices) return report(voices.error());
  nlohmann::json list = nlohmann::json::array();
  for (const std::string& model : voices->models) {
    const fs::path file = fs::path(options.output) / (model + ".modes");
    if (!fs::exists(file)) return report({file.string(), "could not be written", "is the disk full?"});
    list.push_back(file.string());
  }
  if (options.json) {
    print_json(list);
  } else if (!common.quiet) {
    fmt::print("{}: {} models, {} newly baked\n", options.output, list.size(), voices->baked);
  }
  return 0;
}

}  // namespace intaglio::app
