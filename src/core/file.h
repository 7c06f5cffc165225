// Reads and writes entire files. All writing is done by core/output_files.h, which says what may be a target.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"

namespace intaglio {

// The bytes of a regular file, whose size is checked before anything is allocated or read: every reader
// states its limit. Errors: not found (with the nearest name in its folder), a folder, unreadable, larger
// than `limit`.
Result<std::vector<std::uint8_t>> read_file(const std::filesystem::path& path, std::uintmax_t limit);

// The same as text.
Result<std::string> read_text(const std::filesystem::path& path, std::uintmax_t limit);

// At most `count` bytes from the beginning, for headers.
Result<std::vector<std::uint8_t>> read_head(const std::filesystem::path& path, std::size_t count);

// Writes all bytes to a descriptor; returns 0, or the errno of what failed.
int write_fully(int descriptor, std::string_view bytes);

// Writes all of `bytes` or nothing, as a set of one OutputFiles. Creates the folder.
Result<void> write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
Result<void> write_file(const std::filesystem::path& path, std::string_view text);

// Checks before long work that `path` can be written: creates its folder and a temporary, and removes the
// latter.
Result<void> check_writable(const std::filesystem::path& path);

// Checks that the extension (in any case) matches the format written, for example ".wav" for `kind` "a WAV
// file": programs choose the format by the name, and a mistyped name must not replace a file of another kind.
Result<void> check_extension(const std::filesystem::path& path, const std::string& extension,
                             const std::string& kind);

}  // namespace intaglio
