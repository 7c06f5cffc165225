// The request to intaglio-netgen: a closed surface to fill.
#pragma once

#include <array>
#include <cstddef>
#include <istream>
#include <optional>
#include <vector>

namespace intaglio::netgen {

struct Request {
  double size = 0;  // element size, m
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<std::size_t, 3>> triangles;
};

// Nothing when it cannot be read. Memory is in proportion to what is there, whatever counts are declared.
std::optional<Request> read_request(std::istream& in);

}  // namespace intaglio::netgen
