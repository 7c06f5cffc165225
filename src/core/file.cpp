#include "core/file.h"
#include "core/text.h"

#include <fcntl.h>
#include <sys/random.h>
#include <unistd.h>

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

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

// Renaming replaces the target, which must be a file, never a device such as /dev/null.
Result<void> check_target(const fs::path& path) {
  std::error_code error;
  if (!path.has_filename())
    return fail(path.empty() ? "\"\"" : path.string(), "is not a file name", "name a file");
  if (fs::is_directory(path, error)) return fail(path.string(), "is a folder", "name a file");
  if (fs::exists(path, error) && !fs::is_regular_file(path, error))
    return fail(path.string(), "is a device or pipe, not a file", "name a file");
  return {};
}

Result<void> make_folder(const fs::path& path) {
  if (!path.has_parent_path()) return {};
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error)
    return fail(path.string(), "cannot create its folder: " + error.message(), "choose a writable location");
  return {};
}

}  // namespace

Result<std::vector<std::uint8_t>> read_file(const fs::path& path, std::uintmax_t limit) {
  std::error_code error;
  if (!fs::exists(path, error)) return not_found(path);
  if (fs::is_directory(path, error)) return fail(path.string(), "is a folder", "name a file");
  if (!fs::is_regular_file(path, error)) return fail(path.string(), "is a device or pipe", "name a file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return fail(path.string(), "cannot be read: " + error.message());
  if (size > limit)
    return fail(path.string(), fmt::format("has {} bytes", size), fmt::format("at most {} are read", limit));
  const File file = open_file(path, "rb");
  if (!file) return fail(path.string(), std::string("cannot be opened: ") + std::strerror(errno));
  std::vector<std::uint8_t> bytes(size);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
  if (bytes.size() != size)
    return fail(path.string(), fmt::format("only {} of {} bytes could be read", bytes.size(), size));
  return bytes;
}

Result<std::string> read_text(const fs::path& path, std::uintmax_t limit) {
  const auto bytes = read_file(path, limit);
  if (!bytes) return tl::unexpected(bytes.error());
  return std::string(bytes->begin(), bytes->end());
}

Result<fs::path> create_temporary(const fs::path& path) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    std::uint32_t number = 0;
    if (getrandom(&number, sizeof number, 0) < 0) break;
    // Before the extension, so that tools which choose a format by it still do.
    const fs::path name = path.parent_path() / fmt::format("{}.{:08x}.part{}", path.stem().string(), number,
                                                           path.extension().string());
    const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file >= 0) {
      close(file);
      return name;
    }
    if (errno != EEXIST) break;
  }
  return fail(path.string(), std::string("cannot be written: ") + std::strerror(errno),
              "choose a writable location");
}

Result<void> check_writable(const fs::path& path) {
  if (auto target = check_target(path); !target) return target;
  if (auto made = make_folder(path); !made) return made;
  const auto temporary = create_temporary(path);
  if (!temporary) return tl::unexpected(temporary.error());
  std::error_code ignored;
  fs::remove(*temporary, ignored);
  return {};
}

Result<void> check_extension(const fs::path& path, const std::string& extension, const std::string& kind) {
  if (lower_case(path.extension().string()) == extension) return {};
  return fail(path.string(), "is not named as " + kind, "end the name with " + extension);
}

Result<void> write_file(const fs::path& path, std::span<const std::uint8_t> bytes) {
  if (auto target = check_target(path); !target) return target;
  if (auto folder = make_folder(path); !folder) return folder;
  const auto made = create_temporary(path);
  if (!made) return tl::unexpected(made.error());
  const fs::path& temporary = *made;
  std::error_code error;
  File file = open_file(temporary, "wb");
  if (!file) {
    const std::string reason = std::strerror(errno);
    fs::remove(temporary, error);
    return fail(path.string(), "cannot be written: " + reason, "choose a writable location");
  }
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
  const bool closed = std::fclose(file.release()) == 0;  // a full disk is often noticed only here
  if (!written || !closed) {
    const std::string reason = std::strerror(errno);
    fs::remove(temporary, error);
    return fail(path.string(), "writing failed: " + reason, "is the disk full?");
  }
  fs::rename(temporary, path, error);
  if (error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return fail(path.string(), "cannot be replaced: " + error.message());
  }
  return {};
}

Result<void> write_file(const fs::path& path, std::string_view text) {
  return write_file(path, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

OutputFiles::~OutputFiles() {
  std::error_code ignored;
  for (const std::filesystem::path& path : paths_) std::filesystem::remove(path, ignored);
}

void OutputFiles::add(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) paths_.push_back(path);
}

}  // namespace intaglio
