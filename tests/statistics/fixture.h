// Fixtures: data sets with their results by SciPy or R, one a line, made by the scripts in fixtures/.
//
// Columns are separated by tabs and named by the first line that is no comment; a cell is one number or
// several, separated by spaces; "nan" is a missing value.
#pragma once

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/source_folder.h"

namespace intaglio::tests {

class FixtureRow {
 public:
  std::map<std::string, std::vector<double>> cells;

  const std::vector<double>& list(const std::string& name) const {
    const auto found = cells.find(name);
    if (found == cells.end()) throw std::runtime_error("the fixture has no column " + name);
    return found->second;
  }
  double number(const std::string& name) const { return list(name).at(0); }
  int integer(const std::string& name) const { return int(number(name)); }
};

inline std::vector<double> numbers(const std::string& text) {
  std::vector<double> out;
  std::istringstream words(text);
  for (std::string word; words >> word;) out.push_back(std::strtod(word.c_str(), nullptr));
  return out;
}

inline std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> out;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, '\t');) out.push_back(cell);
  return out;
}

inline std::vector<FixtureRow> read_fixture(const std::string& name) {
  std::ifstream file(std::string(source_folder) + "/tests/statistics/fixtures/" + name);
  if (!file) throw std::runtime_error("no fixture " + name);
  std::vector<FixtureRow> rows;
  std::vector<std::string> names;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    const auto cells = cells_of(line);
    if (names.empty()) {
      names = cells;
      continue;
    }
    FixtureRow row;
    for (std::size_t k = 0; k < names.size(); ++k)
      row.cells[names[k]] = k < cells.size() ? numbers(cells[k]) : std::vector<double>();
    rows.push_back(std::move(row));
  }
  return rows;
}

// Within 1e-9 of the expected value, relative for values above 1; or both are no number.
inline bool agrees(double value, double expected, double tolerance = 1e-9) {
  if (std::isnan(value) || std::isnan(expected)) return std::isnan(value) && std::isnan(expected);
  if (std::isinf(value) || std::isinf(expected)) return value == expected;
  return std::abs(value - expected) <= tolerance * std::max(1.0, std::abs(expected));
}

}  // namespace intaglio::tests
