// SHA-256 (FIPS 180-4) of bytes that come in pieces: the hashes of designs and stream files in a store, by
// which another program (sha256sum) can check them. One thread at a time; about 200 MB/s.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "intaglio/error.h"

namespace intaglio::study {

class Sha256 {
 public:
  void add(std::string_view bytes);
  // The hash in 64 lower-case hexadecimal digits. Nothing is added afterwards.
  std::string finish();

 private:
  void add_block(const unsigned char* block);

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, 64> block_{};
  std::size_t filled_ = 0;
  std::uint64_t bytes_ = 0;
};

std::string sha256(std::string_view bytes);

struct HashedFile {
  std::string sha256;
  std::int64_t bytes = 0;
};
// Reads in pieces of 1 MiB. Errors: no such file, unreadable.
Result<HashedFile> hash_file(const std::filesystem::path& path);

}  // namespace intaglio::study
