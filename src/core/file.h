// Whole files, read and written without surprises: a write goes to a temporary beside the target and is
// renamed into place, so that a failure leaves no half-written output.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"

namespace intaglio {

// The bytes of a regular file. Errors: absent (with the nearest name in its folder), a folder, unreadable,
// larger than `limit`.
Result<std::vector<std::uint8_t>> read_file(const std::filesystem::path& path,
                                            std::uintmax_t limit = 1u << 30);

// Writes all of `bytes` or nothing. Creates the folder. What is there already must be a file: a device or a
// pipe is refused, since renaming would replace it.
Result<void> write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
Result<void> write_file(const std::filesystem::path& path, std::string_view text);

// A new, empty file beside `path`, to be written and renamed onto it; whoever asked for it removes it when
// that fails. Its name is its own (a file that exists is never touched, nor a link followed), so that two
// processes may write one target: the last to finish wins, whole.
Result<std::filesystem::path> temporary_for(const std::filesystem::path& path);

// Makes sure, before any long work, that `path` can be written: creates its folder and a temporary, and
// removes the latter.
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

// Whether the name tells what is written, `kind` ("a WAV file") with `extension` (".wav"; in any case): what
// reads it chooses by its name, and a mistyped name must not replace a file of another kind.
Result<void> check_named(const std::filesystem::path& path, const std::string& extension,
                         const std::string& kind);

}  // namespace intaglio
