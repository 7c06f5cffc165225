// How cost grows: bench_scaling [--json] [--quick] [--large] [--plot FILE.svg].
//
// The cost of each sense against the size of the texture (256 to 4096 texels a side, with --large 8192),
// the number of bodies (1 to 5000), of modes (100 to 100,000), the servo rate (1 to 8 kHz) and the number
// of surfaces (1 to 64). Medians of interleaved rounds, in thread-CPU time; pictures in the process's.
// `exponent` is that of the power law fitted by least squares of the logarithms, with its standard error;
// `last` that between the last two sizes, which says where a constant part has become small. `real time
// until` is the size at which the cost meets the limit, between two that were measured; nothing is
// extrapolated. --quick: fewer and smaller sizes, 20 s.
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "bench/flags.h"
#include "bench/machine.h"
#include "bench/plot/log_plot.h"
#include "bench/scaling/law.h"

using namespace intaglio;
using namespace intaglio::bench;

namespace {

Result<std::vector<Law>> measure(const Effort& effort) {
  std::vector<Law> laws;
  for (const auto& axis : {scale_texture, scale_bodies, scale_modes, scale_servo_rate, scale_surfaces}) {
    auto found = axis(effort);
    if (!found) return found;
    laws.insert(laws.end(), found->begin(), found->end());
    fmt::print(stderr, "bench_scaling: {} done\n", laws.back().axis);
  }
  return laws;
}

std::string reach(const Law& law) {
  if (!(law.limit > 0)) return "-";
  const double until = holds_until(law);
  if (until == 0) return fmt::format("none ({})", law.limit_name);
  if (std::isinf(until)) return fmt::format("{:g} and more ({})", law.sizes.back(), law.limit_name);
  return fmt::format("{:.3g} ({})", until, law.limit_name);
}

void print_table(const std::vector<Law>& laws) {
  fmt::print("{:<23}{:<15}{:<38}{:>10}{:>8}{:>8}  {:<30}{}\n", "against", "sense", "unit", "exponent", "s.e.",
             "last", "real time until", "size: cost");
  for (const Law& law : laws) {
    const Fit f = fit(law);
    fmt::print("{:<23}{:<15}{:<38}{:>10.3f}{:>8.3f}{:>8.2f}  {:<30}", law.axis, law.sense, law.unit,
               f.exponent, f.standard_error, f.last, reach(law));
    for (std::size_t k = 0; k < law.sizes.size(); ++k)
      fmt::print("{:.4g}: {:.4g}  ", law.sizes[k], law.costs[k]);
    fmt::print("\n");
  }
}

void print_json(const std::vector<Law>& laws) {
  fmt::print("{{\"machine\": \"{}\", \"laws\": [\n", machine());
  for (std::size_t n = 0; n < laws.size(); ++n) {
    const Law& law = laws[n];
    const Fit f = fit(law);
    fmt::print("  {{\"axis\": \"{}\", \"sense\": \"{}\", \"unit\": \"{}\", \"exponent\": {:.4f}, ", law.axis,
               law.sense, law.unit, f.exponent);
    fmt::print("\"standard_error\": {:.4f}, \"last\": {:.4f}, \"limit\": {:.6g}, \"points\": [",
               f.standard_error, f.last, law.limit);
    for (std::size_t k = 0; k < law.sizes.size(); ++k)
      fmt::print("{}[{:g}, {:.6g}]", k == 0 ? "" : ", ", law.sizes[k], law.costs[k]);
    fmt::print("]}}{}\n", n + 1 < laws.size() ? "," : "");
  }
  fmt::print("]}}\n");
}

// A panel for each unit and axis. Senses keep their colours.
Result<void> plot(const std::string& file, const std::vector<Law>& laws) {
  std::vector<Panel> panels;
  std::string before;
  for (const Law& law : laws) {
    if (law.axis + law.unit == before) {
      panels.back().series.push_back({law.sense, law.sizes, law.costs});
      continue;
    }
    before = law.axis + law.unit;
    panels.push_back({fmt::format("{}, {}", law.sense, law.axis),
                      law.axis,
                      law.unit,
                      {{law.sense, law.sizes, law.costs}}});
    // A limit far above all costs would flatten the curve.
    if (law.limit > 0 && law.limit < 30 * law.costs.back()) {
      panels.back().limit = law.limit;
      panels.back().limit_name = law.limit_name;
    }
  }
  return write_log_plot(file, "Cost against size", panels);
}

}  // namespace

int main(int argc, char** argv) {
  const auto flags = Flags::parse(argc, argv, {"--json", "--quick", "--large"}, {"--plot"});
  if (!flags) return 2;
  const auto laws = measure({flags->has("--quick"), flags->has("--large")});
  if (!laws) {
    fmt::print(stderr, "bench_scaling: {}\n", laws.error().message());
    return 1;
  }
  if (flags->has("--plot")) {
    if (const auto written = plot(flags->value("--plot"), *laws); !written) {
      fmt::print(stderr, "bench_scaling: {}\n", written.error().message());
      return 1;
    }
  }
  if (flags->has("--json")) {
    print_json(*laws);
    return 0;
  }
  fmt::print("{}\n", machine());
  print_table(*laws);
  return 0;
}
