// Any bytes as a stream file: records within the bytes that came, or one clear error on one line; and what
// was read is read again from the frames that it makes.
#include "study/store/stream_file.h"

#include <cstring>
#include <optional>

#include "fuzz/require.h"

using namespace intaglio;
using namespace intaglio::study;

namespace {

// Rewrites the frames' checksums and numbers, so that mutations get behind them.
std::string with_checksums(std::string bytes) {
  std::size_t at = stream_magic.size();
  for (std::uint32_t number = 0; at + 20 <= bytes.size(); ++number) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + at + 8, sizeof size);
    if (size > bytes.size() - at - 20) break;
    std::memcpy(bytes.data() + at, &frame_mark, sizeof frame_mark);
    std::memcpy(bytes.data() + at + 12, &number, sizeof number);
    const std::uint32_t crc = crc32({bytes.data() + at + 20, size}, crc32({bytes.data() + at + 4, 12}));
    std::memcpy(bytes.data() + at + 16, &crc, sizeof crc);
    at += 20 + size;
  }
  return bytes;
}

void try_bytes(std::string_view bytes) {
  const auto file = parse_stream(bytes, "fuzz.stream");
  if (!file) return fuzz::require_clear(file.error(), "fuzz.stream:");
  fuzz::require(file->values.size() * sizeof(double) <= bytes.size());
  fuzz::require(file->values.size() == file->rows() * file->header.columns.size());
  fuzz::require(!file->is_complete || file->torn_bytes == 0);
  std::string again(stream_magic);
  append_frame(again, FrameKind::header, 0, header_text(file->header));
  append_records(again, 1, file->values);
  append_dropped(again, 2, file->dropped);
  append_frame(again, FrameKind::end, 3, {});
  const auto second = parse_stream(again, "again");
  fuzz::require(second.has_value() && second->is_complete && second->header == file->header);
  fuzz::require(second->dropped == file->dropped && second->values.size() == file->values.size());
  if (!file->values.empty())
    fuzz::require(
        std::memcmp(second->values.data(), file->values.data(), file->values.size() * sizeof(double)) == 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::as_text(data, size);
  try_bytes(bytes);
  if (bytes.starts_with(stream_magic)) try_bytes(with_checksums(std::string(bytes)));
  return 0;
}
