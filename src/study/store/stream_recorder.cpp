#include "study/store/stream_recorder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "core/file.h"
#include "core/output_files.h"

namespace intaglio::study {

namespace {

constexpr std::chrono::milliseconds flush_interval{20};
constexpr std::size_t max_pending = 8 << 20;

}  // namespace

Stream::Stream(StreamHeader header, std::filesystem::path path, int descriptor)
    : header_(std::move(header)), path_(std::move(path)), descriptor_(descriptor), pending_(stream_magic) {
  append_frame(pending_, FrameKind::header, frames_++, header_text(header_));
}

bool Stream::push(std::span<const double> values) {
  Record record{};
  std::copy_n(values.begin(), std::min(values.size(), header_.columns.size()), record.begin());
  if (queue_.push(record)) return true;
  dropped_.fetch_add(1, std::memory_order_relaxed);
  return false;
}

void Stream::take() {
  const std::size_t columns = header_.columns.size();
  std::vector<double> values;
  while (const Record* record = queue_.front()) {
    if (pending_.size() + values.size() * sizeof(double) < max_pending) {
      values.insert(values.end(), record->begin(), record->begin() + std::ptrdiff_t(columns));
      ++records_;
    } else {
      dropped_.fetch_add(1, std::memory_order_relaxed);
    }
    queue_.pop();
  }
  if (!values.empty()) append_records(pending_, frames_++, values);
  const std::uint64_t dropped = dropped_.load(std::memory_order_relaxed);
  if (dropped > written_drops_ && pending_.size() < max_pending) {
    append_dropped(pending_, frames_++, dropped - written_drops_);
    written_drops_ = dropped;
  }
}

void Stream::write() {
  if (pending_.empty()) return;
  if (const int reason = write_fully(descriptor_, pending_); reason != 0) {
    error_ = write_error(path_, reason);
    // A frame that is cut short would hide those that follow.
    if (::ftruncate(descriptor_, offset_) == 0) (void)::lseek(descriptor_, offset_, SEEK_SET);
    return;
  }
  offset_ += std::int64_t(pending_.size());
  pending_.clear();
  error_.reset();
}

StreamRecorder::StreamRecorder() : thread_([this] { run(); }) {}

StreamRecorder::~StreamRecorder() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  thread_.join();
  for (const auto& stream : streams_) {
    stream->take();
    stream->write();
    ::close(stream->descriptor_);
  }
}

void StreamRecorder::run() {
  std::unique_lock lock(mutex_);
  while (!ends_) {
    for (const auto& stream : streams_) {
      stream->take();
      stream->write();
    }
    wake_.wait_for(lock, flush_interval, [this] { return ends_; });
  }
}

Result<Stream*> StreamRecorder::open(const std::filesystem::path& path, const StreamHeader& header) {
  if (auto checked = check_header(header); !checked) return tl::unexpected(checked.error());
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor < 0) return tl::unexpected(write_error(path, errno));
  std::unique_ptr<Stream> stream(new Stream(header, path, descriptor));
  stream->write();
  if (stream->error_) {
    const Error error = *stream->error_;
    ::close(descriptor);
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    return tl::unexpected(error);
  }
  const std::lock_guard lock(mutex_);
  streams_.push_back(std::move(stream));
  return streams_.back().get();
}

Result<StreamEnd> StreamRecorder::close(Stream* wanted) {
  std::unique_ptr<Stream> stream;
  {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(streams_.begin(), streams_.end(), [&](const auto& s) { return s.get() == wanted; });
    if (found == streams_.end()) return fail("stream", "it is closed already", "");
    stream = std::move(*found);
    streams_.erase(found);
  }
  stream->take();
  append_frame(stream->pending_, FrameKind::end, stream->frames_++, {});
  stream->write();
  if (!stream->error_ && ::fsync(stream->descriptor_) != 0)
    stream->error_ = write_error(stream->path_, errno);
  ::close(stream->descriptor_);
  if (stream->error_) return tl::unexpected(*stream->error_);
  return StreamEnd{stream->records_, stream->dropped_.load(std::memory_order_relaxed)};
}

std::optional<Error> StreamRecorder::error() const {
  const std::lock_guard lock(mutex_);
  for (const auto& stream : streams_)
    if (stream->error_) return stream->error_;
  return std::nullopt;
}

}  // namespace intaglio::study
