// The file of a high-rate stream (pose, force, contacts, audio clock): records of numbers behind checksums,
// appended while a trial runs, so that a process that is killed leaves a file of which all but the last write
// is readable.
//
// Layout, little-endian: 8 bytes "INTSTRM1", then frames of
//   u32 0x314d5246 | u32 kind | u32 payload bytes | u32 number of the frame, from 0 | u32 CRC-32 of kind to
//   payload without itself | payload
// Kinds: 1 header (text, the first frame), 2 records (doubles, row by row), 3 records dropped since the last
// such frame (u64), 4 end (empty). A reader stops at the first frame that is cut short or wrong.
//
// Times are seconds of the session's clock. Any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"

namespace intaglio::study {

// Most columns of a stream.
inline constexpr std::size_t max_stream_columns = 16;
// A file's first bytes.
inline constexpr std::string_view stream_magic = "INTSTRM1";
inline constexpr std::uint32_t frame_mark = 0x314d5246;
inline constexpr std::uintmax_t max_stream_bytes = std::uintmax_t(1) << 30;

enum class FrameKind : std::uint32_t { header = 1, records = 2, dropped = 3, end = 4 };

struct StreamColumn {
  std::string name;       // "x", "force_z"
  std::string unit;       // "m", "N"; empty: a number without one
  std::string type;       // a channel type of BIDS: POS, ORNT, VEL, ..., LATENCY, MISC
  std::string component;  // x, y, z, quat_w, ...; n/a
  std::string point;      // the tracked point, such as "pen"; n/a
  bool operator==(const StreamColumn&) const = default;
};

struct StreamHeader {
  std::string name;  // "pose", "contacts": letters, digits and _
  std::string session;
  std::int64_t step = 0, attempt = 1;
  double rate_hz = 0;  // nominal; 0: events, at no fixed rate
  bool synthetic = false;
  std::vector<StreamColumn> columns;  // the first is the time, in s
  bool operator==(const StreamHeader&) const = default;
};

struct StreamFile {
  StreamHeader header;
  std::vector<double> values;  // row by row
  std::uint64_t dropped = 0;   // records that the queue had no room for
  bool is_complete = false;    // ends as a file does that was closed
  std::size_t torn_bytes = 0;  // after the last readable frame

  std::size_t rows() const { return header.columns.empty() ? 0 : values.size() / header.columns.size(); }
  double at(std::size_t row, std::size_t column) const {
    return values[row * header.columns.size() + column];
  }
};

// Errors: not a stream file, no readable header.
Result<StreamFile> parse_stream(std::string_view bytes, const std::string& name);
Result<StreamFile> load_stream(const std::filesystem::path& path);

// Checks a header: names in letters, digits and _; 1 to 16 columns; the first "time" in s.
Result<void> check_header(const StreamHeader& header);
std::string header_text(const StreamHeader& header);

void append_frame(std::string& bytes, FrameKind kind, std::uint32_t number, std::string_view payload);
void append_records(std::string& bytes, std::uint32_t number, std::span<const double> values);
void append_dropped(std::string& bytes, std::uint32_t number, std::uint64_t count);

// CRC-32 of IEEE 802.3, as in zlib; `before` continues another.
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

}  // namespace intaglio::study
