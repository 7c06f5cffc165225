#include "netgen/request.h"

#include <string>

namespace intaglio::netgen {

std::optional<Request> read_request(std::istream& in) {
  Request request;
  std::string word;
  int version = 0;
  std::size_t points = 0, triangles = 0;
  if (!(in >> word >> version >> request.size >> points >> triangles) || word != "intaglio-netgen" ||
      version != 1 || !(request.size > 0))
    return std::nullopt;
  for (std::size_t k = 0; k < points; ++k) {
    auto& [x, y, z] = request.points.emplace_back();
    if (!(in >> x >> y >> z)) return std::nullopt;
  }
  for (std::size_t k = 0; k < triangles; ++k) {
    auto& [a, b, c] = request.triangles.emplace_back();
    if (!(in >> a >> b >> c) || a >= points || b >= points || c >= points) return std::nullopt;
  }
  return request;
}

}  // namespace intaglio::netgen
