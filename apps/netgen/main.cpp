// intaglio-netgen REQUEST RESULT: fills the closed surface in the file REQUEST with tetrahedra by Netgen and
// writes them to the file RESULT. Run by src/sound/bake/fem/mesher.cpp, which sets the limits and checks
// what comes back; a process of its own since Netgen may crash or hang. Exit codes: 2 the request cannot be
// read, 3 Netgen refused the surface, 4 it failed to fill it, 5 the result cannot be written.
//
//   request: "intaglio-netgen 1", element size, number of points and triangles, then all of them
//   result:  "intaglio-tetrahedra 1", number of points and tetrahedra, then all of them; indices from 0
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <optional>

#include "netgen/request.h"

namespace nglib {
#include <nglib.h>
}

using namespace intaglio;

namespace {

bool write(const char* path, nglib::Ng_Mesh* mesh) {
  std::FILE* out = std::fopen(path, "w");
  if (!out) return false;
  const int points = nglib::Ng_GetNP(mesh), tets = nglib::Ng_GetNE(mesh);
  std::fprintf(out, "intaglio-tetrahedra 1\n%d %d\n", points, tets);
  for (int k = 1; k <= points; ++k) {
    double p[3];
    nglib::Ng_GetPoint(mesh, k, p);
    std::fprintf(out, "%.17g %.17g %.17g\n", p[0], p[1], p[2]);
  }
  for (int k = 1; k <= tets; ++k) {
    int corners[NG_VOLUME_ELEMENT_MAXPOINTS];
    nglib::Ng_GetVolumeElement(mesh, k, corners);
    std::fprintf(out, "%d %d %d %d\n", corners[0] - 1, corners[1] - 1, corners[2] - 1, corners[3] - 1);
  }
  return std::fclose(out) == 0;
}

// Netgen frees nothing that it is given; the process's end does.
int fill(netgen::Request& request, const char* result) {
  using namespace nglib;
  Ng_Init();
  Ng_STL_Geometry* geometry = Ng_STL_NewGeometry();
  for (const auto& [a, b, c] : request.triangles)
    Ng_STL_AddTriangle(geometry, request.points[a].data(), request.points[b].data(),
                       request.points[c].data());
  Ng_Meshing_Parameters how;
  how.maxh = request.size;
  how.grading = 0.3;
  how.second_order = 0;
  how.elementsperedge = 1;
  how.elementspercurve = 1;
  how.closeedgeenable = 0;
  if (Ng_STL_InitSTLGeometry(geometry) != NG_OK) return 3;
  Ng_Mesh* mesh = Ng_NewMesh();
  if (Ng_STL_MakeEdges(geometry, mesh, &how) != NG_OK) return 3;
  if (Ng_STL_GenerateSurfaceMesh(geometry, mesh, &how) != NG_OK) return 3;
  if (Ng_GenerateVolumeMesh(mesh, &how) != NG_OK || Ng_GetNE(mesh) == 0) return 4;
  return write(result, mesh) ? 0 : 5;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) _exit(2);
  std::ifstream file(arguments[1]);
  std::optional<netgen::Request> request = netgen::read_request(file);
  if (!request) _exit(2);
  int code = 4;
  try {
    code = fill(*request, arguments[2]);
  } catch (...) {
  }
  _exit(code);  // skips Netgen's global destructors
}
