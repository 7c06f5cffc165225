// Meshes at levels of detail against textures at lower resolutions (§1.4.4.2 of Sterling & Lin 2016):
// bench_lod [--json] [--quick] [--plot-cost FILE.svg] [--plot-memory FILE.svg].
//
// The brick of 4 m and 512 x 512 texels; chains of meshes that meshoptimizer makes of the mesh with a
// vertex at each texel, by four metrics, and by leaving out rows (bench/lod/lod_mesh.h); the texture at
// 512 to 32 texels. For each, the errors of picture, contact and sound against the full relief
// (lod_error.h) and what it costs each sense (lod_cost.h; thread-CPU time, of pictures the process's,
// medians of interleaved rounds). Then: what a mesh costs at a texture's error and errs at its cost, by
// the line between neighbours of a chain on logarithmic axes; and which mesh is best for which sense at
// the same number of triangles. --quick: 256 x 256, fewer levels.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/flags.h"
#include "bench/floors.h"
#include "bench/lod/lod_cost.h"
#include "bench/lod/lod_error.h"
#include "bench/lod/lod_mesh.h"
#include "bench/machine.h"
#include "bench/plot/log_plot.h"

using namespace intaglio;
using namespace intaglio::bench;

namespace {

struct Level {
  std::string family;
  double share = 0;        // wanted size over the full one, in triangles or texels
  std::size_t pieces = 0;  // triangles or texels
  double bytes = 0;
  LodError error;
  LodCost cost;
};

// One sense: what it costs and how it errs.
struct Sense {
  const char *name, *cost_label, *error_label;
  double (*cost)(const Level&);
  double (*error)(const Level&);
};

const std::array<Sense, 3> senses = {
    {{"picture", "CPU-ms a frame", "RMS angle of normals, degrees",
      [](const Level& l) { return l.cost.picture_ms; }, [](const Level& l) { return l.error.normal_deg; }},
     {"contact", "CPU-us a step of 100 balls", "RMS height of a ball, mm",
      [](const Level& l) { return l.cost.contact_us; }, [](const Level& l) { return l.error.ball_mm; }},
     {"sound", "CPU-ns a sample of slope", "RMS of the slope's spectrum, dB",
      [](const Level& l) { return l.cost.sound_ns; }, [](const Level& l) { return l.error.sound_db; }}}};

constexpr std::array<LodMetric, 5> metrics = {LodMetric::geometry, LodMetric::shading, LodMetric::heights,
                                              LodMetric::contact, LodMetric::grid};
const std::string texture_family = "texture";

Result<std::vector<Level>> measure(bool quick) {
  const SharedSurface full = bricks(quick ? 256 : 512);
  const int raster = 1024;
  const LodErrors errors(raster_of(*full, raster));
  const LodChain chain(*full);
  std::vector<Level> levels;
  std::vector<LodWay> ways;
  for (int size = full->width(); size >= 32; size /= quick ? 4 : 2) {
    ways.push_back({size == full->width() ? full : reduced(*full, size)});
    const surface::Surface& texture = *ways.back().texture;
    levels.push_back({texture_family,
                      std::pow(double(size) / full->width(), 2),
                      std::size_t(size) * std::size_t(size),
                      double(texture.memory_bytes()),
                      errors.of(raster_of(texture, raster)),
                      {}});
  }
  const std::vector<double> shares =
      quick ? std::vector{1.0, 0.1, 0.01} : std::vector{1.0, 0.5, 0.25, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002};
  for (const LodMetric metric : metrics) {
    for (const double share : shares) {
      if (metric == LodMetric::grid && share == 0.5) continue;  // no whole number of rows
      ways.push_back({nullptr, chain.mesh(metric, share)});
      const LodMesh& mesh = ways.back().mesh;
      levels.push_back({name_of(metric),
                        share,
                        mesh.triangles.size(),
                        mesh.bytes(),
                        errors.of(raster_of(mesh, floor_side, raster)),
                        {}});
    }
    fmt::print(stderr, "bench_lod: {} made\n", name_of(metric));
  }
  const auto costs = lod_costs(full, ways, quick ? 1 : 5);
  if (!costs) return tl::unexpected(costs.error());
  for (std::size_t k = 0; k < levels.size(); ++k) levels[k].cost = (*costs)[k];
  return levels;
}

std::vector<const Level*> family_of(const std::vector<Level>& levels, const std::string& name) {
  std::vector<const Level*> out;
  for (const Level& level : levels)
    if (level.family == name) out.push_back(&level);
  return out;
}

// The least y of a chain whose x is at most `wanted`: of its members, or between two neighbours, on the line
// between them on logarithmic axes. Nothing where every x is above.
std::optional<double> least(const std::vector<const Level*>& chain, double (*x)(const Level&),
                            double (*y)(const Level&), double wanted) {
  std::optional<double> best;
  const auto note = [&](double value) { best = std::min(best.value_or(value), value); };
  for (std::size_t k = 0; k < chain.size(); ++k) {
    if (x(*chain[k]) <= wanted) note(y(*chain[k]));
    if (k + 1 == chain.size()) break;
    const double xa = x(*chain[k]), xb = x(*chain[k + 1]), ya = y(*chain[k]), yb = y(*chain[k + 1]);
    if (std::min({xa, xb, ya, yb}) <= 0 || (wanted - xa) * (wanted - xb) > 0 || xa == xb) continue;
    note(ya * std::pow(yb / ya, std::log(wanted / xa) / std::log(xb / xa)));
  }
  return best;
}

struct Comparison {
  std::string sense;
  int texels = 0;  // a side, of the texture
  double error = 0, cost = 0, bytes = 0;
  // The best mesh of any chain has these; nothing where no chain comes there.
  std::optional<double> cost_at_error, error_at_cost, bytes_at_error;
  std::string cheapest, truest;
};

std::vector<Comparison> compare(const std::vector<Level>& levels) {
  std::vector<Comparison> out;
  for (const Sense& sense : senses) {
    for (const Level* texture : family_of(levels, texture_family)) {
      Comparison c;
      c.sense = sense.name;
      c.texels = int(std::lround(std::sqrt(double(texture->pieces))));
      c.error = sense.error(*texture);
      c.cost = sense.cost(*texture);
      c.bytes = texture->bytes;
      for (const LodMetric metric : metrics) {
        const auto chain = family_of(levels, name_of(metric));
        const auto cost = least(chain, sense.error, sense.cost, c.error);
        if (cost && (!c.cost_at_error || *cost < *c.cost_at_error)) {
          c.cost_at_error = cost;
          c.cheapest = name_of(metric);
        }
        const auto bytes = least(
            chain, sense.error, [](const Level& l) { return l.bytes; }, c.error);
        if (bytes && (!c.bytes_at_error || *bytes < *c.bytes_at_error)) c.bytes_at_error = bytes;
        const auto error = least(chain, sense.cost, sense.error, c.cost);
        if (error && (!c.error_at_cost || *error < *c.error_at_cost)) {
          c.error_at_cost = error;
          c.truest = name_of(metric);
        }
      }
      out.push_back(c);
    }
  }
  return out;
}

// At about the same number of triangles, the chain that is best for each sense.
struct Budget {
  double share = 0;
  std::array<const Level*, 3> best = {};
};

std::vector<Budget> budgets(const std::vector<Level>& levels) {
  std::vector<Budget> out;
  for (const Level& level : levels) {
    if (level.family != name_of(LodMetric::geometry) || level.share >= 0.5) continue;
    Budget budget{level.share, {}};
    for (std::size_t s = 0; s < senses.size(); ++s) {
      for (const Level& other : levels) {
        if (other.family == texture_family || other.share != level.share) continue;
        if (!budget.best[s] || senses[s].error(other) < senses[s].error(*budget.best[s]))
          budget.best[s] = &other;
      }
    }
    out.push_back(budget);
  }
  return out;
}

void print_levels(const std::vector<Level>& levels) {
  fmt::print("{:<20}{:>10}{:>9}{:>11}{:>10}{:>10}{:>10}{:>12}{:>12}{:>11}\n", "what", "pieces", "MB",
             "normal, deg", "depth, mm", "ball, mm", "sound, dB", "picture, ms", "contact, us", "sound, ns");
  for (const Level& l : levels) {
    fmt::print("{:<20}{:>10}{:>9.3f}{:>11.3f}{:>10.3f}{:>10.3f}{:>10.2f}{:>12.2f}{:>12.1f}{:>11.1f}\n",
               l.family, l.pieces, l.bytes / 1e6, l.error.normal_deg, l.error.depth_mm, l.error.ball_mm,
               l.error.sound_db, l.cost.picture_ms, l.cost.contact_us, l.cost.sound_ns);
  }
}

// Memory of all senses: each with its own best mesh at the texture's error, against the one texture.
void print_memory(const std::vector<Comparison>& comparisons) {
  fmt::print("\nMB of the best mesh for each sense at a texture's errors, and of that texture\n");
  for (const Comparison& first : comparisons) {
    if (first.sense != senses[0].name) continue;
    double sum = 0;
    std::string parts;
    for (const Comparison& c : comparisons) {
      if (c.texels != first.texels) continue;
      sum += c.bytes_at_error.value_or(std::nan("")) / 1e6;
      parts += fmt::format("{:>9} {:<7}", c.sense,
                           c.bytes_at_error ? fmt::format("{:.3f}", *c.bytes_at_error / 1e6) : "none");
    }
    fmt::print("{:>6} texels {}   all {:<10}texture {:.3f}\n", first.texels, parts,
               std::isfinite(sum) ? fmt::format("{:.3f}", sum) : "-", first.bytes / 1e6);
  }
}

std::string optional_number(const std::optional<double>& value, double by) {
  return value ? fmt::format("{:.4g} ({:.3g} times)", *value, *value / by) : "no mesh";
}

void print_comparisons(const std::vector<Comparison>& comparisons) {
  fmt::print(
      "\na texture, and the best mesh of any chain at its error and at its cost\n{:<9}{:>7}{:>10}{:>10}{:>26}  "
      "{:<20}{:>26}  {}\n",
      "sense", "texels", "error", "cost", "cost at that error", "by", "error at that cost", "by");
  for (const Comparison& c : comparisons) {
    fmt::print("{:<9}{:>7}{:>10.4g}{:>10.4g}{:>26}  {:<20}{:>26}  {}\n", c.sense, c.texels, c.error, c.cost,
               optional_number(c.cost_at_error, c.cost), c.cheapest,
               c.error > 0 ? optional_number(c.error_at_cost, c.error)
                           : (c.error_at_cost ? fmt::format("{:.4g}", *c.error_at_cost) : "no mesh"),
               c.truest);
  }
}

void print_budgets(const std::vector<Budget>& all) {
  fmt::print("\nthe best mesh for each sense (rows), and what it errs in the others over their best\n");
  fmt::print("{:<10}{:<10}{:<20}{:>16}{:>16}{:>16}\n", "share", "sense", "best", "in picture", "in contact",
             "in sound");
  int different = 0;
  for (const Budget& budget : all) {
    for (std::size_t s = 0; s < senses.size(); ++s) {
      fmt::print("{:<10}{:<10}{:<20}", s == 0 ? fmt::format("{:g}", budget.share) : "", senses[s].name,
                 budget.best[s]->family);
      for (std::size_t other = 0; other < senses.size(); ++other) {
        const double ratio = senses[other].error(*budget.best[s]) / senses[other].error(*budget.best[other]);
        fmt::print("{:>16.3g}", ratio);
      }
      fmt::print("\n");
    }
    if (budget.best[0] != budget.best[1] || budget.best[1] != budget.best[2]) ++different;
  }
  fmt::print("at {} of {} sizes no mesh is best for all three senses\n", different, all.size());
}

void print_json(const std::vector<Level>& levels) {
  fmt::print("{{\"machine\": \"{}\", \"levels\": [\n", machine());
  const char* comma = "";
  for (const Level& l : levels) {
    fmt::print(
        "{}  {{\"what\": \"{}\", \"share\": {:g}, \"pieces\": {}, \"bytes\": {:.0f}, \"normal_deg\": {:.5g}, "
        "\"depth_mm\": {:.5g}, \"ball_mm\": {:.5g}, \"sound_db\": {:.5g}, \"picture_ms\": {:.5g}, "
        "\"contact_us\": {:.5g}, \"sound_ns\": {:.5g}}}",
        comma, l.family, l.share, l.pieces, l.bytes, l.error.normal_deg, l.error.depth_mm, l.error.ball_mm,
        l.error.sound_db, l.cost.picture_ms, l.cost.contact_us, l.cost.sound_ns);
    comma = ",\n";
  }
  fmt::print("\n]}}\n");
}

Result<void> plot(const std::string& file, const std::vector<Level>& levels, bool by_memory) {
  std::vector<std::string> families = {texture_family};
  for (const LodMetric metric : metrics) families.push_back(name_of(metric));
  std::vector<Panel> panels;
  for (const Sense& sense : senses) {
    Panel panel{sense.name, by_memory ? "MB" : sense.cost_label, sense.error_label, {}};
    for (const std::string& family : families) {
      Series series{family, {}, {}};
      for (const Level* level : family_of(levels, family)) {
        if (level->share >= 1) {  // without error but for rounding
          if (family != texture_family) continue;
          panel.mark = by_memory ? level->bytes / 1e6 : sense.cost(*level);
          panel.mark_name = "full texture";
          continue;
        }
        series.xs.push_back(by_memory ? level->bytes / 1e6 : sense.cost(*level));
        series.ys.push_back(sense.error(*level));
      }
      panel.series.push_back(series);
    }
    panels.push_back(panel);
  }
  return write_log_plot(file, by_memory ? "Error against memory" : "Error against cost", panels);
}

}  // namespace

int main(int argc, char** argv) {
  const auto flags = Flags::parse(argc, argv, {"--json", "--quick"}, {"--plot-cost", "--plot-memory"});
  if (!flags) return 2;
  const auto levels = measure(flags->has("--quick"));
  if (!levels) {
    fmt::print(stderr, "bench_lod: {}\n", levels.error().message());
    return 1;
  }
  for (const bool by_memory : {false, true}) {
    const std::string file = flags->value(by_memory ? "--plot-memory" : "--plot-cost");
    if (file.empty()) continue;
    if (const auto written = plot(file, *levels, by_memory); !written) {
      fmt::print(stderr, "bench_lod: {}\n", written.error().message());
      return 1;
    }
  }
  if (flags->has("--json")) {
    print_json(*levels);
    return 0;
  }
  fmt::print("{}\n", machine());
  print_levels(*levels);
  const std::vector<Comparison> comparisons = compare(*levels);
  print_comparisons(comparisons);
  print_memory(comparisons);
  print_budgets(budgets(*levels));
  return 0;
}
