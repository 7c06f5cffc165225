#include "intaglio/material.h"
#include "core/text.h"

#include <fmt/format.h>
#include <array>
#include <vector>

namespace intaglio {

namespace {

constexpr MicroRoughness polished{1e-7, 1e-5, -2.8};
constexpr MicroRoughness machined{2e-6, 5e-5, -2.4};
constexpr MicroRoughness sandblasted{1e-5, 1e-4, -2.2};
constexpr MicroRoughness cast{1e-4, 1e-3, -2.0};

}  // namespace

std::span<const Material> materials() {
  // name, density, Young, Poisson, alpha, beta, friction, restitution, rolling resistance, micro
  static const std::array<Material, 9> all{{
      {"ceramic", 2700, 7.2e10, 0.19, 6, 1e-7, 0.4, 0.6, 0.001, polished},
      {"glass", 2600, 6.2e10, 0.20, 1, 1e-7, 0.4, 0.7, 0.001, polished},
      {"wood", 750, 1.1e10, 0.25, 60, 2e-6, 0.5, 0.5, 0.003, sandblasted},
      {"plastic", 1070, 1.4e9, 0.35, 30, 1e-6, 0.4, 0.7, 0.003, machined},
      {"iron", 8000, 2.1e11, 0.28, 5, 1e-7, 0.4, 0.6, 0.001, cast},
      {"polycarbonate", 1190, 2.4e9, 0.37, 0.5, 4e-7, 0.4, 0.75, 0.002, machined},
      {"steel", 7850, 2.0e11, 0.29, 5, 3e-8, 0.4, 0.7, 0.001, machined},
      {"brick", 2400, 3e10, 0.20, 10, 8e-7, 0.7, 0.6, 0.004, cast},
      {"stone", 2700, 5e10, 0.25, 25, 1.5e-6, 0.6, 0.6, 0.003, sandblasted},
  }};
  return all;
}

Result<Material> find_material(std::string_view name) {
  std::vector<std::string> names;
  for (const Material& material : materials()) {
    if (material.name == name) return material;
    names.push_back(material.name);
  }
  const std::string nearest = nearest_name(std::string(name), names);
  return fail("", fmt::format("no material is called \"{}\"", name),
              fmt::format("{}known: {}", nearest.empty() ? "" : "did you mean \"" + nearest + "\"? ",
                          fmt::join(names, ", ")));
}

}  // namespace intaglio
