#include "core/file_stream.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/file.h"

namespace intaglio {

namespace {

constexpr std::size_t buffered_bytes = 1 << 16;

}  // namespace

Result<FileStream> FileStream::create(OutputFiles& files, const std::filesystem::path& target) {
  const auto temporary = files.add(target);
  if (!temporary) return tl::unexpected(temporary.error());
  const int descriptor = open(temporary->c_str(), O_WRONLY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return tl::unexpected(write_error(target, errno));
  return FileStream(target, descriptor);
}

FileStream::FileStream(FileStream&& other) noexcept
    : target_(std::move(other.target_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      buffer_(std::move(other.buffer_)),
      error_(std::move(other.error_)) {}

FileStream::~FileStream() {
  if (descriptor_ >= 0) close(descriptor_);
}

void FileStream::write(std::string_view text) {
  if (error_) return;
  buffer_ += text;
  if (buffer_.size() >= buffered_bytes) flush();
}

void FileStream::flush() {
  if (const int reason = error_ ? 0 : write_fully(descriptor_, buffer_); reason != 0)
    error_ = write_error(target_, reason);
  buffer_.clear();
}

Result<void> FileStream::finish() {
  flush();
  if (close(std::exchange(descriptor_, -1)) != 0 && !error_) error_ = write_error(target_, errno);
  if (error_) return tl::unexpected(*error_);
  return {};
}

}  // namespace intaglio
