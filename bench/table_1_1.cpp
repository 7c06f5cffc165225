// Table 1.1 of Sterling & Lin 2016, measured on this machine: bench_table_1_1 [--json] [--quick]
// [--dense-10000] [--every-vertex].
//
// Memory of the mesh, of modal analysis and of the sound at run time, and times of physics, picture and
// touch, for normal map, relief map, and meshes of 256 x 256 and 512 x 512 vertices, the paper's values
// beside them. No number is extrapolated: what was not run is called so. Each cell is described in
// bench/table_1_1/*.h. Times are CPU time, medians and 99th percentiles of interleaved rounds, so that
// other work on the machine falls on all alike. The dense method runs at 1,000 to 5,000 unknowns, and at
// 10,000 with --dense-10000 (three minutes; LAPACK needed when built); --every-vertex analyses bodies of
// which each vertex of the fine mesh is a node (two minutes, 7 GB). --quick: fewer rounds, no meshes in
// modal analysis, 10 s.
#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "bench/flags.h"
#include "bench/machine.h"
#include "bench/table_1_1/modal.h"
#include "bench/table_1_1/physics.h"
#include "bench/table_1_1/picture.h"
#include "bench/table_1_1/touch.h"

using namespace intaglio::bench;

namespace {

const std::vector<std::string> representations = {"normal map", "relief map", "coarse mesh", "fine mesh"};

// One cell: what was measured of a representation.
struct Cell {
  std::string what, representation;
  double value = 0;
  std::optional<double> p99 = {};
  std::string unit;
};

// The paper's, in the units below; extrapolated ones are marked. 0: none.
struct PaperColumn {
  std::string what, unit;
  std::vector<double> values;
  bool extrapolated_meshes = false;
};

const std::vector<PaperColumn> columns = {
    {"mesh", "MB", {0.010, 0.110, 4.5, 19}},
    {"offline", "MB", {2.7, 1000, 288e3, 4500e3}, true},
    {"runtime", "MB", {0.27, 18, 450, 1700}, true},
    {"physics, rolling", "us", {175, 2200, 3000, 4900}},
    {"physics, thrown", "us", {175, 2200, 3000, 4900}},
    {"visual", "us", {486, 900, 2100, 7000}},
    {"haptic", "us", {60, 60, 0, 0}},
};

struct Results {
  std::vector<Cell> cells;
  std::vector<DenseCost> dense;
  std::vector<std::string> notes;
  std::string device = "no picture was drawn";

  void add(const std::string& what, const std::string& representation, double value, const std::string& unit,
           std::optional<double> p99 = std::nullopt) {
    cells.push_back({what, representation, value, p99, unit});
  }
  const Cell* find(const std::string& what, const std::string& representation) const {
    for (const Cell& cell : cells)
      if (cell.what == what && cell.representation == representation) return &cell;
    return nullptr;
  }
  double value(const std::string& what, const std::string& representation) const {
    const Cell* cell = find(what, representation);
    return cell ? cell->value : std::nan("");
  }
};

void progress(const std::string& what) {
  fmt::print(stderr, "bench_table_1_1: {}\n", what);
}

void add_modal(Results& results, const std::string& representation, const std::optional<ModalCost>& cost) {
  if (!cost) {
    results.notes.push_back(fmt::format("modal analysis of the {} failed", representation));
    return;
  }
  results.add("mesh", representation, cost->mesh_bytes / 1e6, "MB");
  results.add("offline", representation, cost->offline_bytes / 1e6, "MB");
  results.add("runtime", representation, cost->runtime_bytes / 1e6, "MB");
  results.add("modal analysis", representation, cost->seconds, "CPU-s");
  results.add("vertices", representation, cost->vertices, "");
  if (cost->elements > 0) results.add("elements", representation, cost->elements, "");
  results.add("modes", representation, cost->modes, "");
  results.add("a dense matrix", representation, dense_matrix_bytes(cost->unknowns) / 1e6, "MB");
}

// Before anything else: each runs in a process of its own, which must not inherit threads.
void measure_modal(Results& results, const Flags& flags) {
  const bool quick = flags.has("--quick");
  progress("modal analysis");
  add_modal(results, "normal map", analyse_spring_shell());
  add_modal(results, "relief map", analyse_slab());
  if (!quick) {
    add_modal(results, "coarse mesh", analyse_mesh(256));
    add_modal(results, "fine mesh", analyse_mesh(512));
  }
  if (flags.has("--every-vertex")) {
    progress("modal analysis with every vertex");
    add_modal(results, "coarse, every vertex a node", analyse_every_vertex(91));
    add_modal(results, "fine, every vertex a node", analyse_every_vertex(181));
  }
  if (!has_dense_method()) {
    results.notes.push_back("dense method: not run, LAPACK was not there when this was built");
    return;
  }
  std::vector<int> sizes = quick ? std::vector<int>{5} : std::vector<int>{5, 7, 11};
  if (flags.has("--dense-10000")) sizes.push_back(16);
  for (const int cells : sizes) {
    progress(fmt::format("dense method, {} unknowns", 9 * (2 * cells + 1) * (2 * cells + 1)));
    if (const auto cost = compare_dense(cells))
      results.dense.push_back(*cost);
    else
      results.notes.push_back("the dense method failed: is there enough memory?");
  }
}

void measure_time(Results& results, bool quick) {
  progress("physics");
  for (const PhysicsCost& row : measure_physics(quick ? 1 : 12)) {
    results.add("physics, rolling", row.floor, row.rolling.median, "us", row.rolling.p99);
    results.add("physics, thrown", row.floor, row.thrown.median, "us", row.thrown.p99);
    results.add("floor built", row.floor, row.build_ms, "ms");
    results.add("floor", row.floor, row.bytes / 1e6, "MB");
  }
  progress("pictures");
  for (const int height : quick ? std::vector<int>{180} : std::vector<int>{180, 360}) {
    const auto pictures = measure_pictures(height * 16 / 9, height, quick ? 1 : 12);
    if (!pictures) {
      results.notes.push_back("pictures: " + pictures.error().message());
      break;
    }
    results.device = pictures->device;
    const std::string what =
        height == 180 ? "visual" : fmt::format("visual, {} x {}", height * 16 / 9, height);
    for (const PictureCost& row : pictures->rows) {
      results.add(what, row.representation, 1e3 * row.frame.median, "us", 1e3 * row.frame.p99);
      if (height == 180) results.add("picture", row.representation, row.device_bytes / 1e6, "MB");
    }
  }
  progress("touch");
  const auto touch = measure_touch(quick ? 10'000 : 100'000, quick ? 1 : 3);
  if (!touch) results.notes.push_back("touch: " + touch.error().message());
  if (!touch) return;
  for (const TouchCost& row : *touch) {
    const std::string what = row.method == "servo" ? "haptic" : "haptic, proxy alone";
    results.add(what, row.representation, row.tick.median, "us", row.tick.p99);
    results.add(what + ", touching", row.representation, row.touching, "");
    results.add(what + ", mean force", row.representation, row.mean_force, "N");
  }
}

std::string number(double value) {
  if (!std::isfinite(value)) return "not run";
  return value >= 1e6 ? fmt::format("{:.3e}", value) : fmt::format("{:.4g}", value);
}

void print_table(const Results& results) {
  fmt::print("\n{:<24}", "measured (paper)");
  for (const PaperColumn& column : columns)
    fmt::print("{:>26}", fmt::format("{}, {}", column.what, column.unit));
  fmt::print("\n");
  for (std::size_t k = 0; k < representations.size(); ++k) {
    fmt::print("{:<24}", representations[k]);
    for (const PaperColumn& column : columns) {
      const std::string paper =
          column.values[k] == 0
              ? "-"
              : fmt::format("{:g}{}", column.values[k], column.extrapolated_meshes && k >= 2 ? "*" : "");
      fmt::print("{:>26}",
                 fmt::format("{} ({})", number(results.value(column.what, representations[k])), paper));
    }
    fmt::print("\n");
  }
  fmt::print("* the paper extrapolated these\n\nall that was measured\n");
  for (const Cell& cell : results.cells) {
    fmt::print("  {:<34}{:<32}{:>12}{}{}\n", cell.what, cell.representation, number(cell.value),
               cell.unit.empty() ? "" : " " + cell.unit, cell.p99 ? ", p99 " + number(*cell.p99) : "");
  }
}

void print_dense(const Results& results) {
  fmt::print("\nthe dense method (LAPACK, all modes) and ours (100 modes), the same matrices\n");
  fmt::print("{:>10}{:>14}{:>12}{:>12}{:>12}{:>14}\n", "unknowns", "dense, MB", "dense, s", "ours, MB",
             "ours, s", "difference");
  for (const DenseCost& d : results.dense) {
    fmt::print("{:>10}{:>14.1f}{:>12.2f}{:>12.1f}{:>12.2f}{:>14.1e}\n", d.unknowns, d.dense_bytes / 1e6,
               d.dense_seconds, d.our_bytes / 1e6, d.our_seconds, d.difference);
  }
  for (const std::string mesh : {"coarse mesh", "fine mesh"}) {
    const double megabytes = results.value("a dense matrix", mesh);
    if (std::isfinite(megabytes))
      fmt::print("{:>10}  {}: not run: {:.0f} GB a matrix\n", 3 * results.value("vertices", mesh), mesh,
                 megabytes / 1e3);
  }
}

struct Ratio {
  std::string what;
  double value, wanted;
  std::string source;
};

std::vector<Ratio> ratios(const Results& r) {
  const auto over = [&](const std::string& what, const std::string& a, const std::string& b) {
    return r.value(what, a) / r.value(what, b);
  };
  return {
      {"physics, rolling: fine mesh / relief map", over("physics, rolling", "fine mesh", "relief map"), 15,
       "goal"},
      {"physics, thrown: fine mesh / relief map", over("physics, thrown", "fine mesh", "relief map"), 10,
       "goal"},
      {"physics, rolling: fine mesh / normal map", over("physics, rolling", "fine mesh", "normal map"), 7,
       "goal"},
      {"physics, thrown: fine mesh / normal map", over("physics, thrown", "fine mesh", "normal map"), 15,
       "goal"},
      {"physics, rolling: fine mesh / normal map", over("physics, rolling", "fine mesh", "normal map"), 28,
       "the paper's"},
      {"physics, thrown: fine mesh / normal map", over("physics, thrown", "fine mesh", "normal map"), 28,
       "the paper's"},
      {"physics, rolling: fine mesh / the paper's normal map",
       over("physics, rolling", "fine mesh", "normal map, literal"), 28, "the paper's"},
      {"physics, rolling: fine mesh by our closest features / relief map",
       over("physics, rolling", "fine mesh, ours", "relief map"), 1, "for comparison"},
      {"physics, thrown: fine mesh by our closest features / relief map",
       over("physics, thrown", "fine mesh, ours", "relief map"), 1, "for comparison"},
      {"visual: fine mesh / normal map", over("visual", "fine mesh", "normal map"), 14.4, "the paper's"},
      {"visual: fine mesh / relief map", over("visual", "fine mesh", "relief map"), 7.8, "the paper's"},
      {"visual: coarse mesh / relief map", over("visual", "coarse mesh", "relief map"), 2.3, "the paper's"},
      {"visual: fine mesh, plain / normal map", over("visual", "fine mesh, plain", "normal map"), 14.4,
       "the paper's"},
      {"visual: fine mesh, plain / relief map, no shadow",
       over("visual", "fine mesh, plain", "relief map, no shadow"), 7.8, "the paper's"},
      {"visual: coarse mesh, plain / relief map, no shadow",
       over("visual", "coarse mesh, plain", "relief map, no shadow"), 2.3, "the paper's"},
      {"visual, 640 x 360: fine mesh, plain / normal map",
       over("visual, 640 x 360", "fine mesh, plain", "normal map"), 14.4, "the paper's"},
      {"visual, 640 x 360: fine mesh, plain / relief map, no shadow",
       over("visual, 640 x 360", "fine mesh, plain", "relief map, no shadow"), 7.8, "the paper's"},
      {"visual, 640 x 360: fine mesh / normal map", over("visual, 640 x 360", "fine mesh", "normal map"),
       14.4, "the paper's"},
      {"visual, 640 x 360: fine mesh / relief map", over("visual, 640 x 360", "fine mesh", "relief map"), 7.8,
       "the paper's"},
      {"haptic, servo: fine mesh / relief map", over("haptic", "fine mesh", "relief map"), 10,
       "the paper's estimate"},
      {"haptic, proxy: finger proxy on fine mesh / relief map",
       over("haptic, proxy alone", "fine mesh", "relief map"), 10, "the paper's estimate"},
      {"offline memory, both by ours: fine mesh / normal map", over("offline", "fine mesh", "normal map"),
       4500e3 / 2.7, "the paper's"},
      {"runtime memory, both by ours: fine mesh / normal map", over("runtime", "fine mesh", "normal map"),
       1700 / 0.27, "the paper's"},
      {"one dense matrix each, not run: fine mesh / normal map",
       over("a dense matrix", "fine mesh", "normal map"), 1e6, "the paper's"},
      {"one dense matrix of the fine mesh / offline memory of our relief map",
       r.value("a dense matrix", "fine mesh") / r.value("offline", "relief map"), 1e6, "the paper's"},
      {"one dense matrix of the fine mesh / offline memory of our normal map",
       r.value("a dense matrix", "fine mesh") / r.value("offline", "normal map"), 1e6, "the paper's"},
  };
}

void print_ratios(const Results& results) {
  fmt::print("\nratios\n");
  for (const Ratio& r : ratios(results)) {
    if (!std::isfinite(r.value)) continue;
    fmt::print("  {:<72}{:>12.4g}   {} {:.4g}: {}\n", r.what, r.value, r.source, r.wanted,
               r.value >= r.wanted ? "reached"
               : r.value < 1       ? "not reached, the mesh is faster"
                                   : "not reached");
  }
  for (const std::string& note : results.notes) fmt::print("  {}\n", note);
}

void print_json(const Results& results) {
  fmt::print("{{\"machine\": \"{}\", \"device\": \"{}\", \"cells\": [\n", machine(), results.device);
  const char* comma = "";
  for (const Cell& cell : results.cells) {
    fmt::print("{}  {{\"what\": \"{}\", \"representation\": \"{}\", \"value\": {:.6g}, \"unit\": \"{}\"",
               comma, cell.what, cell.representation, cell.value, cell.unit);
    if (cell.p99) fmt::print(", \"p99\": {:.6g}", *cell.p99);
    fmt::print("}}");
    comma = ",\n";
  }
  fmt::print("\n], \"dense\": [\n");
  comma = "";
  for (const DenseCost& d : results.dense) {
    fmt::print(
        "{}  {{\"unknowns\": {}, \"dense_mb\": {:.1f}, \"dense_s\": {:.3f}, \"ours_mb\": {:.1f}, \"ours_s\": "
        "{:.3f}, \"difference\": {:.2e}}}",
        comma, d.unknowns, d.dense_bytes / 1e6, d.dense_seconds, d.our_bytes / 1e6, d.our_seconds,
        d.difference);
    comma = ",\n";
  }
  fmt::print("\n], \"ratios\": [\n");
  comma = "";
  for (const Ratio& r : ratios(results)) {
    if (!std::isfinite(r.value)) continue;
    fmt::print("{}  {{\"what\": \"{}\", \"value\": {:.6g}, \"wanted\": {:.6g}, \"source\": \"{}\"}}", comma,
               r.what, r.value, r.wanted, r.source);
    comma = ",\n";
  }
  fmt::print("\n], \"notes\": [");
  comma = "";
  for (const std::string& note : results.notes) {
    fmt::print("{}\"{}\"", comma, note);
    comma = ", ";
  }
  fmt::print("]}}\n");
}

}  // namespace

int main(int argc, char** argv) {
  const auto flags = Flags::parse(argc, argv, {"--json", "--quick", "--dense-10000", "--every-vertex"});
  if (!flags) return 2;
  Results results;
  measure_modal(results, *flags);
  measure_time(results, flags->has("--quick"));
  if (flags->has("--json")) {
    print_json(results);
    return 0;
  }
  fmt::print("{}\n{}\n", machine(), results.device);
  print_table(results);
  print_dense(results);
  print_ratios(results);
  return 0;
}
