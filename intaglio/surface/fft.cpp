#include "intaglio/surface/fft.h"

#include <algorithm>
#include <cstddef>

#include "intaglio/core/fourier.h"

namespace intaglio::surface {

void fft2(std::vector<std::complex<float>>& data, int width, int height, Transform transform) {
  using Complex = std::complex<float>;
  Fourier<float> row(width, transform == Transform::inverse), column(height, transform == Transform::inverse);
  const auto w = static_cast<std::size_t>(width);
  const auto h = static_cast<std::size_t>(height);
  std::vector<Complex> line(w), spectrum(w);
  for (std::size_t y = 0; y < h; ++y) {
    std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(y * w), w, line.begin());
    row(data.data() + y * w, line.data());
  }
  // Columns, sixteen at a time: one cache line a row instead of one value.
  constexpr std::size_t batch = 16;
  std::vector<Complex> columns(h * batch), out(h);
  for (std::size_t x0 = 0; x0 < w; x0 += batch) {
    const std::size_t n = std::min(batch, w - x0);
    for (std::size_t y = 0; y < h; ++y) {
      for (std::size_t k = 0; k < n; ++k) columns[k * h + y] = data[y * w + x0 + k];
    }
    for (std::size_t k = 0; k < n; ++k) {
      column(out.data(), columns.data() + k * h);
      std::copy(out.begin(), out.end(), columns.begin() + static_cast<std::ptrdiff_t>(k * h));
    }
    for (std::size_t y = 0; y < h; ++y) {
      for (std::size_t k = 0; k < n; ++k) data[y * w + x0 + k] = columns[k * h + y];
    }
  }
}

}  // namespace intaglio::surface
