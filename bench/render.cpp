// Cost and accuracy of a picture: bench_render [--json] [TEXELS].
//
// The texture is the built-in brick, 1 m a side and 2 cm deep, 512 x 512 unless TEXELS says otherwise. One
// renderer for each way of drawing it, the same cameras (from above, from aside, grazing), in turn in one
// run: times are CPU time of the process, all threads of the driver included (on a graphics card they are
// only what the driver spends), median and 99th percentile over frames, a frame being drawn and read back.
// `relief` is the exact search through the pyramid, `classic` 32 linear and 6 binary steps, `mesh` the same
// texture as displaced triangles. Errors are against the mesh of 1024 x 1024 squares: RMS of the linear depth
// where both see the surface, as a share of the relief's depth, and the share of pixels that only one covers.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bench/arguments.h"
#include "bench/brick.h"
#include "intaglio/representation.h"
#include "render/renderer.h"

using namespace intaglio;
using namespace intaglio::render;

namespace {

double process_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

struct Way {
  std::string name;
  RendererOptions options;
  Representation representation = Representation::relief;
  bool looks_away = false;
  std::unique_ptr<Renderer> renderer = {};
  std::vector<double> ms = {};

  double at(double share) {
    std::sort(ms.begin(), ms.end());
    return ms[std::min(ms.size() - 1, std::size_t(share * double(ms.size())))];
  }
};

// Eye and target of the views, the surface lying about the origin in y = 0.
std::vector<Camera> cameras() {
  std::vector<Camera> out(3);
  out[0].eye = Vec3(0.05, 0.9, 0.35);
  out[1].eye = Vec3(0.05, 0.48, 0.62);
  out[2].eye = Vec3(0.3, 0.12, 0.7);
  out[2].target = Vec3(0, 0, 0.1);
  return out;
}

RendererOptions sized(int width, int height) {
  RendererOptions out;
  out.width = width;
  out.height = height;
  out.supersample = 1;
  return out;
}

Way way(std::string name, RendererOptions options, March march, int shadow_steps, int mesh_cells = 0,
        Representation representation = Representation::relief) {
  options.march = march;
  options.shadow_steps = shadow_steps;
  options.displaced_mesh_cells = mesh_cells;
  return {std::move(name), options, representation};
}

bool prepare(std::vector<Way>& ways, const surface::Surface& surface) {
  for (Way& w : ways) {
    auto renderer = Renderer::create(surface, w.options);
    if (!renderer) {
      fmt::print(stderr, "bench_render: {}\n", renderer.error().message());
      return false;
    }
    w.renderer = std::move(*renderer);
  }
  return true;
}

FrameScene scene_of(const Way& way, const Camera& camera) {
  FrameScene scene;
  scene.camera = camera;
  if (way.looks_away) scene.camera.target = 2 * camera.eye - camera.target;
  scene.representation = way.representation;
  return scene;
}

// All ways in turn, so that a busy machine is busy for all of them.
void measure(std::vector<Way>& ways, int rounds) {
  for (int k = -1; k < rounds; ++k) {
    for (const Camera& camera : cameras()) {
      for (Way& w : ways) {
        const FrameScene scene = scene_of(w, camera);
        const double start = process_seconds();
        w.renderer->draw(scene);
        if (k >= 0) w.ms.push_back(1e3 * (process_seconds() - start));
      }
    }
  }
}

struct Deviation {
  double rms = 0, mismatch = 0;
};

Deviation deviation(Way& way, Way& truth, double depth) {
  double sum = 0, both = 0, one = 0, all = 0;
  for (const Camera& camera : cameras()) {
    way.renderer->draw(scene_of(way, camera));
    truth.renderer->draw(scene_of(truth, camera));
    const auto a = way.renderer->depth(), b = truth.renderer->depth();
    for (std::size_t k = 0; k < a.size(); ++k, ++all) {
      if (std::isfinite(a[k]) != std::isfinite(b[k])) ++one;
      if (!std::isfinite(a[k]) || !std::isfinite(b[k])) continue;
      sum += (double(a[k]) - b[k]) * (double(a[k]) - b[k]);
      ++both;
    }
  }
  return {std::sqrt(sum / std::max(both, 1.0)) / depth, one / all};
}

struct Ratio {
  std::string what;
  double value;
  std::string wanted;
};

void print(std::vector<Way>& ways, int width, int height, bool json) {
  for (Way& w : ways) {
    if (json)
      fmt::print("{{\"what\":\"{}\",\"width\":{},\"height\":{},\"median_ms\":{:.3f},\"p99_ms\":{:.3f}}}\n",
                 w.name, width, height, w.at(0.5), w.at(0.99));
    else
      fmt::print("{:34} {:4} x {:<4} {:9.2f} {:9.2f}\n", w.name, width, height, w.at(0.5), w.at(0.99));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto args = bench::arguments(argc, argv, "bench_render", 64, {512});
  if (!args) return 2;
  const surface::Surface surface = bench::brick(args->sizes.front());
  const int texels = args->sizes.front();
  using enum March;

  std::vector<Way> searches;
  searches.push_back(way("relief, no shadow", sized(640, 360), pyramid, 0));
  searches.push_back(way("classic, no shadow", sized(640, 360), classic, 0));
  searches.push_back(way("relief", sized(640, 360), pyramid, 32));
  searches.push_back(way("classic", sized(640, 360), classic, 32));
  std::vector<Way> shapes;
  const RendererOptions small = sized(320, 180);
  shapes.push_back(way("relief", small, pyramid, 32));
  shapes.push_back(way(fmt::format("mesh, {} squares a side", texels), small, pyramid, 32, texels));
  shapes.push_back(way(fmt::format("mesh, {} squares a side", texels / 2), small, pyramid, 32, texels / 2));
  shapes.push_back(way("normal map", small, pyramid, 32, 0, Representation::normal));
  shapes.push_back(way("flat", small, pyramid, 32, 0, Representation::flat));
  shapes.push_back(way("an empty picture", small, pyramid, 32));
  shapes.back().looks_away = true;
  std::vector<Way> truth;
  truth.push_back(way("mesh, 1024 squares a side", sized(640, 360), pyramid, 0, 1024));
  if (!prepare(searches, surface) || !prepare(shapes, surface) || !prepare(truth, surface)) return 1;

  if (!args->json) {
    fmt::print("{}\n\n{:34} {:>11} {:>9} {:>9}\n", searches[0].renderer->device(), "what", "pixels", "ms",
               "p99");
  }
  measure(searches, 8);
  measure(shapes, 16);
  print(searches, 640, 360, args->json);
  print(shapes, 320, 180, args->json);
  const Deviation exact = deviation(searches[0], truth[0], surface.max_depth());
  const Deviation stepped = deviation(searches[1], truth[0], surface.max_depth());
  const auto bytes = shapes[1].renderer->device_bytes();
  const double colour = 4.0 / 3 * 4 * double(surface.colour().data.size() / 3);
  const std::vector<Ratio> ratios = {
      {"relief over classic, no shadow", searches[0].at(0.5) / searches[1].at(0.5), "<= 0.9"},
      {"relief over classic, with shadow", searches[2].at(0.5) / searches[3].at(0.5), "<= 0.8"},
      {"fine mesh over relief", shapes[1].at(0.5) / shapes[0].at(0.5), ">= 7.8"},
      {"coarse mesh over relief", shapes[2].at(0.5) / shapes[0].at(0.5), ">= 2.3"},
      {"fine mesh over normal map", shapes[1].at(0.5) / shapes[3].at(0.5), ">= 14.4"},
      {"depth error, share of the relief", exact.rms, "<= 0.01"},
      {"depth error of classic", stepped.rms, ""},
      {"pixels covered by one only", exact.mismatch, "<= 0.0001"},
      {"pixels covered by one only, classic", stepped.mismatch, ""},
      {"memory of fine mesh over textures", double(bytes.meshes) / (double(bytes.textures) - colour), ">= 5"},
  };
  if (!args->json) fmt::print("\n");
  for (const Ratio& r : ratios) {
    if (args->json)
      fmt::print("{{\"what\":\"{}\",\"value\":{:.6g},\"wanted\":\"{}\"}}\n", r.what, r.value, r.wanted);
    else
      fmt::print("{:40} {:10.4g}   {}\n", r.what, r.value, r.wanted);
  }
  return 0;
}
