#include "sound/bake/fem/mesher.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "core/file.h"
#include "core/process.h"
#include "sound/bake/fem/fill_surface.h"
#include "sound/bake/fem/lattice.h"
#include "sound/bake/fem/netgen_files.h"
#include "sound/bake/fem/sharp_edges.h"

namespace intaglio::sound {

namespace {

namespace fs = std::filesystem;

constexpr double netgen_edge_per_cell = 0.65;  // gives as many elements as the lattice

// A file without a name, which a child process opens by a path. However this process ends, nothing is left.
class NamelessFile {
 public:
  NamelessFile() : descriptor_(memfd_create("netgen", MFD_CLOEXEC)) {}
  NamelessFile(const NamelessFile&) = delete;
  NamelessFile& operator=(const NamelessFile&) = delete;
  ~NamelessFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  std::string path() const {
    return fmt::format("/proc/{}/fd/{}", getpid(), descriptor_);  // Not in a name
  }
  bool write(std::string_view text) const { return descriptor_ >= 0 && write_fully(descriptor_, text) == 0; }

 private:
  int descriptor_;
};

constexpr double aligned_cosine = 0.985;       // 10 degrees
constexpr double min_skew_length = 0.05;       // of all such edges, over the bounding box's diagonal
constexpr std::size_t max_triangles = 20'000;  // for Netgen to be chosen automatically
constexpr double max_seconds = 20;

}  // namespace

fs::path find_netgen() {
  if (const char* named = std::getenv("INTAGLIO_NETGEN"))
    return fs::exists(named) ? fs::path(named) : fs::path();
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& folder : {here, here.parent_path()}) {
    if (fs::exists(folder / "intaglio-netgen", error)) return folder / "intaglio-netgen";
  }
  return {};
}

Result<FilledSurface> netgen_fill(const BodySurface& body, const FillOptions& options,
                                  const NetgenOptions& netgen, const std::string& name) {
  if (!body.is_closed() || body.thickness > 0)
    return fail(name, "is not closed, as Netgen requires", "use --mesher lattice");
  const fs::path program = netgen.program.empty() ? find_netgen() : netgen.program;
  if (program.empty())
    return fail(
        name, "cannot be filled by Netgen: there is no program intaglio-netgen",
        "install Debian's libnglib-dev (script/setup netgen) and build again, or use --mesher lattice");
  const NamelessFile request, result;
  const double thickness = 2 * body.volume / body.area;
  const double smallest = std::cbrt(body.volume * 6 / options.max_elements);
  const double size = std::max(netgen_edge_per_cell * std::min(options.element_size, thickness), smallest);
  if (!request.write(netgen_request(body, size)) || !result.write(""))
    return fail(name, std::string("no file for Netgen: ") + std::strerror(errno));
  const auto in_context = [&](const Error& error) {
    return fail(name, error.message(), "use --mesher lattice, which fills any surface");
  };
  if (auto run =
          run_limited(program, {request.path(), result.path()}, "/", {netgen.seconds, netgen.memory_mb});
      !run)
    return in_context(run.error());
  const auto bytes = read_file(result.path(), 1u << 30);
  if (!bytes || bytes->empty()) return in_context({program.filename().string(), "returned nothing", ""});
  auto corners = parse_netgen_result({reinterpret_cast<const char*>(bytes->data()), bytes->size()},
                                     program.filename().string());
  if (!corners) return in_context(corners.error());
  if (!fills(*corners, body))
    return in_context({program.filename().string(), "returned tetrahedra that do not fill the body", ""});
  if (double(corners->tets.size()) > 1.5 * options.max_elements)
    return in_context({program.filename().string(),
                       fmt::format("made {} elements, more than the {} allowed", corners->tets.size(),
                                   options.max_elements),
                       ""});
  const auto surface = SurfaceQuery::make(body, name);
  if (!surface) return tl::unexpected(surface.error());
  FilledSurface filled{quadratic_mesh(std::move(corners->points), std::move(corners->tets)), size, body.notes,
                       "netgen"};
  fit_surface(filled.mesh, body, *surface, filled.notes);
  return filled;
}

bool has_skew_edges(const BodySurface& body, double element_size) {
  std::vector<SharpEdge> skew = find_sharp_edges(body);
  const double least = min_skew_length * (body.high - body.low).norm();
  if (!(total_length(skew, body) > least)) return false;
  const Mat3 axes = flat_frame(body.points, body.triangles);
  const auto is_aligned = [&](const Vec3& n) {
    return (axes.transpose() * n).cwiseAbs().maxCoeff() > aligned_cosine;
  };
  std::erase_if(skew, [&](const SharpEdge& e) { return is_aligned(e.left) && is_aligned(e.right); });
  const double length = total_length(skew, body);
  return length > least && length * element_size < body.area;
}

Result<FilledSurface> fill_with(Mesher mesher, const BodySurface& body, const FillOptions& options,
                                const NetgenOptions& netgen, const std::string& name) {
  if (mesher == Mesher::netgen) return netgen_fill(body, options, netgen, name);
  std::string note;
  if (mesher == Mesher::automatic && body.is_closed() && body.thickness == 0 && body.shells == 1 &&
      body.triangles.size() <= max_triangles && has_skew_edges(body, options.element_size)) {
    NetgenOptions limited = netgen;
    limited.seconds = std::min(netgen.seconds, max_seconds);
    if (limited.program.empty() && find_netgen().empty()) {
      note =
          "its sharp edges are not aligned with the lattice, which keeps most of them; install Netgen "
          "(script/setup netgen) to keep all";
    } else {
      auto filled = netgen_fill(body, options, limited, name);
      if (filled) return filled;
      note = fmt::format("Netgen failed ({}); used the lattice", filled.error().message());
    }
  }
  auto filled = fill_surface(body, options, name);
  if (filled && !note.empty()) filled->notes.push_back(note);
  return filled;
}

}  // namespace intaglio::sound
