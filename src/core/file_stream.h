// A file of a set that is written piece by piece, as results are made, so that it is never held whole.
//
//   auto log = FileStream::create(files, "out/a.csv");
//   log->write(row);                        // as often as needed
//   if (auto written = log->finish(); !written) return written;
//   return files.commit();
//
// Buffers 64 KB. One thread at a time; closed by finish() before the set is committed (core/output_files.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/output_files.h"
#include "intaglio/error.h"

namespace intaglio {

class FileStream {
 public:
  // Adds `target` to the set.
  static Result<FileStream> create(OutputFiles& files, const std::filesystem::path& target);
  FileStream(FileStream&& other) noexcept;
  ~FileStream();

  // The first error is kept, and nothing is written after it, so that callers need not check every piece.
  void write(std::string_view text);
  const std::optional<Error>& error() const { return error_; }
  // Writes what is left and closes the file. Returns the first error.
  Result<void> finish();

 private:
  FileStream(std::filesystem::path target, int descriptor)
      : target_(std::move(target)), descriptor_(descriptor) {}
  void flush();

  std::filesystem::path target_;  // as the caller gave it, for messages
  int descriptor_;
  std::string buffer_;
  std::optional<Error> error_;
};

}  // namespace intaglio
