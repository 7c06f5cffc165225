// Reads and writes entire files. A write goes to a temporary next to the target and is renamed into place, so
// that a failure leaves no half-written output.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"

namespace intaglio {

// The bytes of a regular file. Errors: not found (with the nearest name in its folder), a folder, unreadable,
// larger than `limit`.
Result<std::vector<std::uint8_t>> read_file(const std::filesystem::path& path,
                                            std::uintmax_t limit = 1u << 30);

// The same as text.
Result<std::string> read_text(const std::filesystem::path& path, std::uintmax_t limit = 1u << 30);

// Writes all of `bytes` or nothing. Creates the folder. An existing target must be a file: a device or a pipe
// is an error, because renaming would replace it.
Result<void> write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
Result<void> write_file(const std::filesystem::path& path, std::string_view text);

// A new, empty file next to `path`, to be written and renamed onto it; the caller removes it on failure. The
// name is unique, so that several processes may write one target: the last rename wins, and the file is never
// mixed.
Result<std::filesystem::path> create_temporary(const std::filesystem::path& path);

// Checks before long work that `path` can be written: creates its folder and a temporary, and removes the
// latter.
Result<void> check_writable(const std::filesystem::path& path);

// The files of a job that fails as a whole: those that it created are removed again unless keep() is called.
class OutputFiles {
 public:
  OutputFiles() = default;
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  // Call before the file is written: one that exists already is not removed.
  void add(const std::filesystem::path& path);
  void keep() { paths_.clear(); }

 private:
  std::vector<std::filesystem::path> paths_;
};

// Checks that the extension (in any case) matches the format written, for example ".wav" for `kind` "a WAV
// file": programs choose the format by the name, and a mistyped name must not replace a file of another kind.
Result<void> check_extension(const std::filesystem::path& path, const std::string& extension,
                             const std::string& kind);

}  // namespace intaglio
