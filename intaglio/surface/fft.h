// Two-dimensional discrete Fourier transform of a complex field, in place, any size (small prime factors are
// fast).
#pragma once

#include <complex>
#include <vector>

namespace intaglio::surface {

enum class Transform { forward, inverse };

// `data` is height x width; the inverse divides by width x height. O(n log n); a megapixel takes about 0.15
// s.
void fft2(std::vector<std::complex<float>>& data, int width, int height, Transform transform);

}  // namespace intaglio::surface
