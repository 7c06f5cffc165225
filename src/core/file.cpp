#include "core/file.h"

#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "core/output_files.h"
#include "core/text.h"

namespace intaglio {

namespace fs = std::filesystem;

namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

File open_file(const fs::path& path, const char* mode) {
  return {std::fopen(path.c_str(), mode), std::fclose};
}

tl::unexpected<Error> not_found(const fs::path& path) {
  std::vector<std::string> names;
  std::error_code ignored;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    names.push_back(entry.path().filename().string());
  const std::string nearest = path.has_filename() ? nearest_name(path.filename().string(), names) : "";
  return fail(path.empty() ? "\"\"" : path.string(), "no such file",
              nearest.empty() ? "" : "did you mean " + (folder / nearest).string() + "?");
}

}  // namespace

namespace {

// The size of a regular file.
Result<std::uintmax_t> size_of(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return not_found(path);
  if (fs::is_directory(path, error)) return fail(path.string(), "is a folder", "name a file");
  if (!fs::is_regular_file(path, error)) return fail(path.string(), "is a device or pipe", "name a file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return fail(path.string(), "cannot be read: " + error.message());
  return size;
}

Result<std::vector<std::uint8_t>> first_bytes(const fs::path& path, std::size_t count) {
  const File file = open_file(path, "rb");
  if (!file) return fail(path.string(), std::string("cannot be opened: ") + std::strerror(errno));
  std::vector<std::uint8_t> bytes(count);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
  if (bytes.size() != count)
    return fail(path.string(), fmt::format("only {} of {} bytes could be read", bytes.size(), count));
  return bytes;
}

}  // namespace

Result<std::vector<std::uint8_t>> read_file(const fs::path& path, std::uintmax_t limit) {
  const auto size = size_of(path);
  if (!size) return tl::unexpected(size.error());
  if (*size > limit)
    return fail(path.string(), fmt::format("has {} bytes", *size), fmt::format("at most {} are read", limit));
  return first_bytes(path, *size);
}

int write_fully(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count < 0 ? errno : ENOSPC;
    bytes.remove_prefix(std::size_t(count));
  }
  return 0;
}

Result<std::vector<std::uint8_t>> read_head(const fs::path& path, std::size_t count) {
  const auto size = size_of(path);
  if (!size) return tl::unexpected(size.error());
  return first_bytes(path, std::size_t(std::min<std::uintmax_t>(*size, count)));
}

Result<std::string> read_text(const fs::path& path, std::uintmax_t limit) {
  const auto bytes = read_file(path, limit);
  if (!bytes) return tl::unexpected(bytes.error());
  return std::string(bytes->begin(), bytes->end());
}

Result<void> check_writable(const fs::path& path) {
  OutputFiles files;
  if (const auto added = files.add(path); !added) return tl::unexpected(added.error());
  return {};
}

Result<void> check_extension(const fs::path& path, const std::string& extension, const std::string& kind) {
  if (lower_case(path.extension().string()) == extension) return {};
  return fail(path.string(), "is not named as " + kind, "end the name with " + extension);
}

Result<void> write_file(const fs::path& path, std::span<const std::uint8_t> bytes) {
  OutputFiles files;
  if (auto written = files.write(path, bytes); !written) return written;
  return files.commit();
}

Result<void> write_file(const fs::path& path, std::string_view text) {
  return write_file(path, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

}  // namespace intaglio
