#include "session/video.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>

#include "core/file.h"

namespace intaglio::session {

namespace fs = std::filesystem;

Result<fs::path> find_ffmpeg() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path candidate = fs::path(folder) / "ffmpeg";
    if (access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return fail("ffmpeg", "not found on PATH", "it encodes the video; install it: sudo apt-get install ffmpeg");
}

Result<std::unique_ptr<VideoWriter>> VideoWriter::create(const fs::path& target, int width, int height,
                                                         int fps) {
  const auto ffmpeg = find_ffmpeg();
  if (!ffmpeg) return tl::unexpected(ffmpeg.error());
  if (auto named = check_extension(target, ".mp4", "an MP4"); !named) return tl::unexpected(named.error());
  if (auto writable = check_writable(target); !writable) return tl::unexpected(writable.error());

  std::unique_ptr<VideoWriter> writer(new VideoWriter);
  writer->ffmpeg_ = *ffmpeg;
  writer->target_ = target;
  for (fs::path* const file : {&writer->video_only_, &writer->muxed_}) {
    auto temporary = create_temporary(target);
    if (!temporary) return tl::unexpected(temporary.error());
    *file = std::move(*temporary);
  }
  // A socket rather than a pipe: when the encoder dies, writing to a pipe raises SIGPIPE in the host.
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return fail(target.string(), std::string("no socket to the encoder: ") + std::strerror(errno));
  writer->socket_ = ends[1];
  SpawnOptions options;
  options.input = ends[0];
  auto process = Process::start(writer->ffmpeg_,
                                {"-v",
                                 "error",
                                 "-y",
                                 "-f",
                                 "rawvideo",
                                 "-pix_fmt",
                                 "rgb24",
                                 "-s",
                                 fmt::format("{}x{}", width, height),
                                 "-r",
                                 std::to_string(fps),
                                 "-i",
                                 "pipe:0",
                                 "-an",
                                 "-c:v",
                                 "libx264",
                                 "-preset",
                                 "veryfast",
                                 "-crf",
                                 "18",
                                 "-threads",
                                 "1",
                                 "-pix_fmt",
                                 "yuv420p",
                                 writer->video_only_.string()},
                                options);
  close(ends[0]);
  if (!process) return tl::unexpected(process.error());
  writer->encoder_ = std::move(*process);
  return writer;
}

VideoWriter::~VideoWriter() {
  if (socket_ >= 0) close(socket_);
  encoder_.reset();  // before its file is removed
  std::error_code ignored;
  fs::remove(video_only_, ignored);
  fs::remove(muxed_, ignored);
}

Result<void> VideoWriter::add(const Image8& frame) {
  std::size_t sent = 0;
  while (sent < frame.data.size()) {
    const ssize_t n = send(socket_, frame.data.data() + sent, frame.data.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const auto ended = encoder_->wait();
      return fail(target_.string(),
                  "the video encoder stopped" + (ended ? "" : ": " + ended.error().message()),
                  "is the disk full?");
    }
    sent += std::size_t(n);
  }
  return {};
}

Result<void> VideoWriter::finish(const fs::path& wav) {
  close(socket_);
  socket_ = -1;
  if (auto encoded = encoder_->wait(); !encoded)
    return fail(target_.string(), "the video encoder failed: " + encoded.error().message(),
                "is the disk full?");
  auto joining = Process::start(
      ffmpeg_, {"-v", "error", "-y", "-i", video_only_.string(), "-i", wav.string(), "-c:v", "copy", "-c:a",
                "aac", "-b:a", "192k", "-movflags", "+faststart", muxed_.string()});
  if (!joining) return tl::unexpected(joining.error());
  if (auto joined = joining->wait(); !joined)
    return fail(target_.string(), "muxing picture and sound failed: " + joined.error().message());
  std::error_code error;
  fs::rename(muxed_, target_, error);
  if (error) return fail(target_.string(), "cannot be replaced: " + error.message());
  return {};
}

}  // namespace intaglio::session
