// Relief with texels smaller than a sample is filtered: closer to the mean of many samples, and unchanged
// where texels are larger.
#include <rapidcheck.h>

#include "render/surface_textures.h"
#include "tests/render/scenes.h"

namespace intaglio::render::test {

namespace {

// Bricks a few texels wide, rough, seen from where a pixel is five texels.
surface::Surface fine_bricks() {
  return make_surface(1024, 1.0, 0.008, [](double u, double v) { return brick_depth(8 * u, 8 * v); });
}

FrameScene from_afar() {
  FrameScene scene = target_scene();
  scene.camera.eye *= 1.3;
  return scene;
}

std::unique_ptr<Renderer> with(const surface::Surface& surface, Detail detail, int supersample = 1,
                               int zoom = 1) {
  RendererOptions options = small_options();
  options.detail = detail;
  options.supersample = supersample;
  options.width *= zoom;
  options.height *= zoom;
  return make_renderer(surface, options);
}

double rms_difference(const Image8& a, const Image8& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.data.size(); ++k) sum += std::pow(double(a.data[k]) - b.data[k], 2);
  return std::sqrt(sum / double(a.data.size()));
}

// The mean depth that zoom x zoom pixels of a larger picture see in each of a smaller one, where all see it.
std::vector<float> mean_depth(const std::vector<float>& large, int zoom) {
  const int width = 160 * zoom;
  std::vector<float> out;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 160; ++x) {
      float sum = 0;
      for (int k = 0; k < zoom * zoom; ++k)
        sum += large[std::size_t((y * zoom + k / zoom) * width + x * zoom + k % zoom)];
      out.push_back(sum / float(zoom * zoom));
    }
  }
  return out;
}

double rms(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0, both = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!std::isfinite(a[k]) || !std::isfinite(b[k])) continue;
    sum += std::pow(double(a[k]) - double(b[k]), 2);
    ++both;
  }
  return std::sqrt(sum / both);
}

}  // namespace

TEST_CASE("filtered far relief is closer to the mean of many samples than single texels are") {
  if (!have_gl()) return;
  const auto surface = fine_bricks();
  const FrameScene scene = from_afar();
  constexpr int zoom = 4;
  const auto truth = with(surface, Detail::every_texel, 4, zoom);
  const auto fine = with(surface, Detail::every_texel);
  const auto mean = with(surface, Detail::by_footprint);
  const auto many = with(surface, Detail::every_texel, 4);
  const Image8 seen = many->draw(scene);
  const double of_fine = rms_difference(fine->draw(scene), seen),
               of_mean = rms_difference(mean->draw(scene), seen);
  truth->draw(scene);
  const auto depth = mean_depth(truth->depth(), zoom);
  const double fine_depth = rms(fine->depth(), depth), mean_depth = rms(mean->depth(), depth);
  MESSAGE("RMS from 16 samples a pixel: every texel " << of_fine << ", by footprint " << of_mean
                                                      << " of 255; depth " << 1e3 * fine_depth << " and "
                                                      << 1e3 * mean_depth << " mm");
  CHECK(of_mean < of_fine);
  CHECK(mean_depth < fine_depth);
}

TEST_CASE("where texels are larger than samples, the picture and the depth are the same to the bit") {
  if (!have_gl()) return;
  const auto surface = make_surface(64, 1.0, 0.02, brick_depth);
  const auto fine = with(surface, Detail::every_texel);
  const auto mean = with(surface, Detail::by_footprint);
  CHECK(fine->draw(target_scene()).data == mean->draw(target_scene()).data);
  CHECK(fine->depth() == mean->depth());
}

TEST_CASE("coarser heights keep a slope, and the pyramid bounds every traced field") {
  CHECK(rc::check([] {
    const int size = *rc::gen::inRange(1, 70);
    const auto values =
        *rc::gen::container<std::vector<int>>(std::size_t(size * size), rc::gen::inRange(0, 1000));
    const auto edge = *rc::gen::element(surface::Edge::wrap, surface::Edge::clamp);
    const auto surface = make_surface(
        size, 1.0, 0.1,
        [&](double u, double v) {
          const auto at = [&](double x) { return std::clamp(int(x * size), 0, size - 1); };
          return values[std::size_t(at(v) * size + at(u))] / 1000.0;
        },
        Quat::Identity(), edge);
    const HeightLevels heights = make_height_levels(surface);
    const HeightPyramid bounds = height_bounds(heights, size + 2, size + 2);
    const int cells = size + 1;
    for (int k = 0; k <= std::min(HeightLevels::coarsest_traced, int(bounds.levels.size()) - 2); ++k) {
      const auto& field = heights.levels[std::size_t(k)];
      for (int above = k; above < int(bounds.levels.size()); ++above) {
        const auto& level = bounds.levels[std::size_t(above)];
        for (int j = 0; j << k < cells; ++j) {
          for (int i = 0; i << k < cells; ++i) {
            const int shift = above - k;
            const float top = level.at(i >> shift, j >> shift);
            RC_ASSERT(std::max({field.at(i, j), field.at(i + 1, j), field.at(i, j + 1),
                                field.at(i + 1, j + 1)}) <= top);
          }
        }
      }
    }
  }));
  const auto plane = make_surface(100, 1.0, 0.1, [](double u, double v) { return 0.2 + 0.5 * u + 0.25 * v; });
  const HeightLevels heights = make_height_levels(plane);
  for (int k = 0; k <= 3; ++k) {
    const auto& field = heights.levels[std::size_t(k)];
    for (int j = 2; j << k < 80; ++j)
      for (int i = 2; i << k < 80; ++i)
        CHECK(std::abs(field.at(i, j) - heights.levels[0].at(i << k, j << k)) <= 2);
  }
}

}  // namespace intaglio::render::test
