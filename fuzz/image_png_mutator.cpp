// Mutations of a PNG with correct checksums: otherwise libspng would reject almost all of them at once.
#include <cstddef>
#include <cstdint>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

std::uint32_t checksum(const std::uint8_t* data, std::size_t size) {
  std::uint32_t sum = 0xffffffff;
  for (std::size_t k = 0; k < size; ++k) {
    sum ^= data[k];
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ ((sum & 1) != 0 ? 0xedb88320u : 0);
  }
  return ~sum;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  size = LLVMFuzzerMutate(data, size, max_size);
  if (seed % 8 == 0) return size;  // some wrong checksums, too
  // After the signature come chunks: a length, a type, so many bytes, the checksum of type and bytes.
  for (std::size_t at = 8; size >= 12 && at <= size - 12;) {
    const std::size_t length =
        std::size_t{data[at]} << 24 | data[at + 1] << 16 | data[at + 2] << 8 | data[at + 3];
    if (length > size - at - 12) break;
    const std::uint32_t sum = checksum(data + at + 4, length + 4);
    for (int k = 0; k < 4; ++k) data[at + 8 + length + std::size_t(k)] = std::uint8_t(sum >> (24 - 8 * k));
    at += length + 12;
  }
  return size;
}
