#include <doctest/doctest.h>

#include <string>

#include "core/toml.h"

using namespace intaglio;

namespace {

// a.a.a ... of `parts` parts.
std::string long_key(int parts, const std::string& part = "a", const std::string& dot = ".") {
  std::string key = part;
  for (int k = 1; k < parts; ++k) key += dot + part;
  return key;
}

}  // namespace

TEST_CASE("keys and headers of very many parts are refused with their line, wherever they stand") {
  for (const int parts : {33, 300000}) {
    const std::string key = long_key(parts);
    for (const std::string& text :
         {"b = 1\n" + key + " = 1\n", "# comment\n[" + key + "]\n", "# a\n[[" + key + "]]\n",
          "\nb = {" + key + " = 1}\n", "\nb = [[{c = 1, " + key + " = 1}]]\n",
          "\n" + long_key(parts, "a", " .\t") + " = 1", "\n" + long_key(parts, "\"a.b\"") + " = 1",
          "\n" + long_key(parts, "'a'") + " = 1", "\nb = [\"\"\"x\"\"\"\"\", {" + key + " = 1}]\n",
          "b = '\\'\n" + key + " = 1", "\nb = \"\\\"\" # \"\n" + key + " = 1"}) {
      const auto table = parse_toml(text, "s.toml");
      REQUIRE_FALSE(table);
      CHECK(table.error().message().find("a key of over 32 parts") != std::string::npos);
      CHECK(table.error().where.rfind("s.toml:", 0) == 0);
    }
  }
}

TEST_CASE("dots in strings, numbers and comments are not keys") {
  const std::string dots(1000, '.');
  const auto table =
      parse_toml("a = \"" + dots + "\" # " + dots + "\nb = '" + dots + "'\nc = \"\"\"\n" + dots +
                     "\n\"\"\"\nd = [1.5, 2.5, -3.5e-1]\n" + long_key(32, "x") + " = 1.25\n",
                 "s.toml");
  CHECK_MESSAGE(table, (table ? "" : table.error().message()));
}
