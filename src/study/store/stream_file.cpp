#include "study/store/stream_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/file.h"
#include "core/text.h"

namespace intaglio::study {

namespace {

static_assert(std::endian::native == std::endian::little, "stream files are little-endian");

constexpr std::size_t frame_head = 20;

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

void append_word(std::string& bytes, std::uint32_t value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

struct Frame {
  FrameKind kind;
  std::string_view payload;
  std::size_t size;
};

// The frame at the beginning of `bytes`, if it is whole and its checksum right.
std::optional<Frame> next_frame(std::string_view bytes, std::uint32_t number) {
  if (bytes.size() < frame_head || word_at(bytes, 0) != frame_mark || word_at(bytes, 12) != number) return {};
  const std::size_t size = word_at(bytes, 8);
  if (size > bytes.size() - frame_head) return {};
  const std::string_view payload = bytes.substr(frame_head, size);
  if (crc32(payload, crc32(bytes.substr(4, 12))) != word_at(bytes, 16)) return {};
  return Frame{FrameKind(word_at(bytes, 4)), payload, frame_head + size};
}

std::vector<std::string> split_at(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

template <class T>
bool parse_whole(const std::string& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

// One line of a header; false: it is not one.
bool put_header_line(StreamHeader& header, const std::vector<std::string>& fields) {
  const std::string& key = fields[0];
  if (key == "column" && fields.size() == 6) {
    header.columns.push_back({fields[1], fields[2], fields[3], fields[4], fields[5]});
    return header.columns.size() <= max_stream_columns;
  }
  if (fields.size() != 2) return false;
  if (key == "stream")
    header.name = fields[1];
  else if (key == "session")
    header.session = fields[1];
  else if (key == "step")
    return parse_whole(fields[1], header.step);
  else if (key == "attempt")
    return parse_whole(fields[1], header.attempt);
  else if (key == "rate")
    return parse_whole(fields[1], header.rate_hz);
  else if (key == "synthetic")
    header.synthetic = fields[1] == "1";
  else
    return false;
  return true;
}

Result<StreamHeader> parse_header(std::string_view text, const std::string& name) {
  StreamHeader header;
  for (const std::string& line : split_at(text, '\n'))
    if (!line.empty() && !put_header_line(header, split_at(line, '\t')))
      return fail(name, fmt::format("its header has the line \"{}\"", printable(line)), "");
  if (auto checked = check_header(header); !checked)
    return fail(name, checked.error().what, checked.error().fix);
  return header;
}

bool is_word(const std::string& text, std::string_view also) {
  return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           also.find(c) != std::string_view::npos;
  });
}

}  // namespace

std::uint32_t crc32(std::string_view bytes, std::uint32_t before) {
  constexpr auto table = [] {
    std::array<std::uint32_t, 256> values{};
    for (std::uint32_t k = 0; k < 256; ++k) {
      std::uint32_t c = k;
      for (int bit = 0; bit < 8; ++bit) c = (c & 1) != 0 ? 0xedb88320u ^ c >> 1 : c >> 1;
      values[k] = c;
    }
    return values;
  }();
  std::uint32_t crc = ~before;
  for (const char byte : bytes) crc = table[(crc ^ std::uint8_t(byte)) & 0xff] ^ crc >> 8;
  return ~crc;
}

Result<void> check_header(const StreamHeader& header) {
  const std::string where = "stream " + printable(header.name);
  if (!is_word(header.name, "_")) return fail(where, "its name is not letters, digits and _", "");
  if (!is_word(header.session, "")) return fail(where, "its session is not letters and digits", "");
  if (header.step < 0 || header.attempt < 1) return fail(where, "its step or attempt is negative", "");
  if (!std::isfinite(header.rate_hz) || header.rate_hz < 0)
    return fail(where, "its rate is not a number of Hz", "0 for events");
  if (header.columns.empty() || header.columns.size() > max_stream_columns)
    return fail(where, "it has no columns, or too many", fmt::format("1 to {}", max_stream_columns));
  if (header.columns[0].name != "time" || header.columns[0].unit != "s")
    return fail(where, "its first column is not the time", "call it time, in s");
  for (const StreamColumn& column : header.columns)
    for (const std::string* text : {&column.name, &column.type, &column.component, &column.point})
      if (!is_word(*text, "_/-"))
        return fail(where, "a column has a word that is not letters, digits and _", "");
  for (const StreamColumn& column : header.columns)
    if (!column.unit.empty() && !is_word(column.unit, "_/-%^. *"))
      return fail(where, "a column has a unit that is not letters and digits", "");
  return {};
}

std::string header_text(const StreamHeader& header) {
  std::string text =
      fmt::format("stream\t{}\nsession\t{}\nstep\t{}\nattempt\t{}\nrate\t{}\nsynthetic\t{}\n", header.name,
                  header.session, header.step, header.attempt, header.rate_hz, header.synthetic ? 1 : 0);
  for (const StreamColumn& c : header.columns)
    text += fmt::format("column\t{}\t{}\t{}\t{}\t{}\n", c.name, c.unit, c.type, c.component, c.point);
  return text;
}

void append_frame(std::string& bytes, FrameKind kind, std::uint32_t number, std::string_view payload) {
  append_word(bytes, frame_mark);
  const std::size_t begin = bytes.size();
  append_word(bytes, std::uint32_t(kind));
  append_word(bytes, std::uint32_t(payload.size()));
  append_word(bytes, number);
  append_word(bytes, crc32(payload, crc32(std::string_view(bytes).substr(begin, 12))));
  bytes.append(payload);
}

void append_records(std::string& bytes, std::uint32_t number, std::span<const double> values) {
  append_frame(bytes, FrameKind::records, number,
               {reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

void append_dropped(std::string& bytes, std::uint32_t number, std::uint64_t count) {
  append_frame(bytes, FrameKind::dropped, number, {reinterpret_cast<const char*>(&count), sizeof count});
}

Result<StreamFile> parse_stream(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with(stream_magic)) return fail(name, "this is not a stream file", "");
  std::string_view rest = bytes.substr(stream_magic.size());
  const auto first = next_frame(rest, 0);
  if (!first || first->kind != FrameKind::header)
    return fail(name, "its header is damaged or cut short", "nothing can be read of it");
  auto header = parse_header(first->payload, name);
  if (!header) return tl::unexpected(header.error());
  StreamFile file;
  file.header = std::move(*header);
  rest.remove_prefix(first->size);
  const std::size_t row_bytes = file.header.columns.size() * sizeof(double);
  for (std::uint32_t number = 1; !file.is_complete; ++number) {
    const auto frame = next_frame(rest, number);
    if (!frame) break;
    if (frame->kind == FrameKind::records && frame->payload.size() % row_bytes == 0) {
      const std::size_t before = file.values.size();
      file.values.resize(before + frame->payload.size() / sizeof(double));
      if (!frame->payload.empty())
        std::memcpy(file.values.data() + before, frame->payload.data(), frame->payload.size());
    } else if (frame->kind == FrameKind::dropped && frame->payload.size() == sizeof file.dropped) {
      std::uint64_t count = 0;
      std::memcpy(&count, frame->payload.data(), sizeof count);
      file.dropped += count;
    } else if (frame->kind == FrameKind::end && frame->payload.empty()) {
      file.is_complete = true;
    } else {
      break;
    }
    rest.remove_prefix(frame->size);
  }
  file.torn_bytes = rest.size();
  file.is_complete = file.is_complete && rest.empty();
  return file;
}

Result<StreamFile> load_stream(const std::filesystem::path& path) {
  const auto text = read_text(path, max_stream_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_stream(*text, path.string());
}

}  // namespace intaglio::study
