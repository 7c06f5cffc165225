#include <doctest/doctest.h>
#include <fmt/format.h>

#include "core/toml.h"

using namespace intaglio;

namespace {

std::string error_of(const std::string& text) {
  const auto material = parse_material(text, "m.toml");
  return material ? "" : material.error().message();
}

}  // namespace

TEST_CASE("every built-in material, and each like it in a file, is within the reader's ranges") {
  for (const Material& m : materials()) {
    CAPTURE(m.name);
    CHECK(parse_material(fmt::format("name = \"{}\"\n", m.name), "m.toml"));
    const auto own = parse_material(
        fmt::format("density = {}\nyoungs_modulus = {:e}\npoisson_ratio = {}\nrayleigh_alpha = {}\n"
                    "rayleigh_beta = {:e}\n",
                    m.density, m.youngs_modulus, m.poisson_ratio, m.rayleigh_alpha, m.rayleigh_beta),
        "m.toml");
    REQUIRE_MESSAGE(own, (own ? "" : own.error().message()));
    CHECK(own->youngs_modulus == m.youngs_modulus);
  }
}

TEST_CASE("materials that no body has are refused with the line, the value and the range") {
  const struct {
    const char* text;
    const char* says;
  } cases[] = {
      {"name = \"steel\"\ndensity = 0.5\n",
       "m.toml:2: density is 0.5; a density must be between 1 and 100000"},
      {"name = \"steel\"\ndensity = 1e6\n", "m.toml:2: density is 1000000"},
      {"name = \"steel\"\nyoungs_modulus = 1\n", "m.toml:2: youngs_modulus is 1; a Young's modulus must be"},
      {"name = \"steel\"\nyoungs_modulus = 1e15\n", "between 1e3 and 1e13 Pa"},
      {"name = \"steel\"\nyoungs_modulus = -2e11\n", "between 1e3 and 1e13 Pa"},
      {"name = \"steel\"\nyoungs_modulus = nan\n", "finite"},
      {"name = \"steel\"\nrayleigh_alpha = 1e9\n", "m.toml:2: rayleigh_alpha is 1000000000; alpha must be"},
      {"name = \"steel\"\nrayleigh_beta = 2\n", "m.toml:2: rayleigh_beta is 2; beta must be"},
      {"name = \"steel\"\npoisson_ratio = 0.5\n", "between -0.9 and 0.49"},
      {"name = \"steel\"\ndensity = 1\nyoungs_modulus = 1e13\n",
       "m.toml:3: sound would be 3.16e+06 m/s fast in it; the square root of youngs_modulus over density must be"},
      {"name = \"steel\"\nyoungs_modulus = 7e5\n", "m.toml:2: sound would be 9.44 m/s fast in it"},
      {"name = \"steel\"\nrayleigh_alpha = 0\nrayleigh_beta = 0\n", "m.toml:2: it would ring for ever; "},
      {"name = \"steel\"\n\ndensity = 1\n", "m.toml:3: sound would be 4.47e+05 m/s"},
  };
  for (const auto& c : cases) {
    const std::string error = error_of(c.text);
    CHECK_MESSAGE(error.find(c.says) != std::string::npos, c.text << " -> " << error);
    CHECK(error.find('\n') == std::string::npos);
  }
}
