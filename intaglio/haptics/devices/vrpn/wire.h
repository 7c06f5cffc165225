// Numbers and text as VRPN puts them on the wire: big-endian, IEEE floats. Reading is bounded: whatever lies
// beyond the end reads as zero and makes ok() false, so that a decoder checks once, at its end, before it
// believes anything. Any thread; no state but the reader's own.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/core/vec.h"

namespace intaglio::haptics::vrpn {

using Bytes = std::vector<std::uint8_t>;
using View = std::span<const std::uint8_t>;

class Reader {
 public:
  explicit Reader(View bytes) : bytes_(bytes) {}

  std::uint32_t u32() { return big_endian<std::uint32_t>(); }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(big_endian<std::uint64_t>()); }
  Vec3 vec3() {
    const double x = f64(), y = f64(), z = f64();
    return {x, y, z};
  }
  // The next `size` bytes; none when there are fewer.
  View raw(std::size_t size) {
    if (size > bytes_.size()) ok_ = false;
    const View taken = ok_ ? bytes_.first(size) : View();
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }

  std::size_t left() const { return bytes_.size(); }
  bool ok() const { return ok_; }                   // nothing was read beyond the end
  bool done() const { return ok_ && left() == 0; }  // and nothing is left over

 private:
  template <std::unsigned_integral T>
  T big_endian() {
    T value = 0;
    for (const std::uint8_t byte : raw(sizeof(T))) value = static_cast<T>(value << 8 | byte);
    return value;
  }

  View bytes_;
  bool ok_ = true;
};

template <std::unsigned_integral T>
void put(Bytes& out, T value) {
  for (int shift = 8 * (static_cast<int>(sizeof(T)) - 1); shift >= 0; shift -= 8)
    out.push_back(static_cast<std::uint8_t>(value >> shift));
}
inline void put(Bytes& out, std::int32_t value) {
  put(out, static_cast<std::uint32_t>(value));
}
inline void put(Bytes& out, float value) {
  put(out, std::bit_cast<std::uint32_t>(value));
}
inline void put(Bytes& out, double value) {
  put(out, std::bit_cast<std::uint64_t>(value));
}
inline void put(Bytes& out, const Vec3& v) {
  for (int k = 0; k < 3; ++k) put(out, v[k]);
}
inline void put(Bytes& out, std::string_view text) {
  out.insert(out.end(), text.begin(), text.end());
}

inline std::string_view text_of(View bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace intaglio::haptics::vrpn
