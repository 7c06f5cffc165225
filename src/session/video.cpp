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
#include "sound/audio/wav.h"

namespace intaglio::session {

namespace fs = std::filesystem;

namespace {

// ffmpeg says why it failed in the last line of its standard error.
tl::unexpected<Error> encoder_error(const fs::path& target, const std::string& what,
                                    const Result<void>& ended) {
  const std::string reason = ended ? "" : ended.error().message();
  if (reason.find(std::strerror(ENOSPC)) != std::string::npos)
    return tl::unexpected(write_error(target, ENOSPC));
  return fail(target.string(), reason.empty() ? what : what + ": " + reason, "is the disk full?");
}

}  // namespace

Result<fs::path> find_ffmpeg() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path candidate = fs::path(folder) / "ffmpeg";
    if (access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return fail("ffmpeg", "not found on PATH", "it encodes the video; install it: sudo apt-get install ffmpeg");
}

Result<std::unique_ptr<VideoWriter>> VideoWriter::create(OutputFiles& files, const fs::path& target,
                                                         int width, int height, int fps) {
  const auto ffmpeg = find_ffmpeg();
  if (!ffmpeg) return tl::unexpected(ffmpeg.error());
  if (auto named = check_extension(target, ".mp4", "an MP4"); !named) return tl::unexpected(named.error());
  std::unique_ptr<VideoWriter> writer(new VideoWriter(files));
  writer->ffmpeg_ = *ffmpeg;
  writer->target_ = target;
  auto muxed = files.add(target);
  if (!muxed) return tl::unexpected(muxed.error());
  writer->muxed_ = std::move(*muxed);
  auto video_only = files.add_scratch(target);
  if (!video_only) return tl::unexpected(video_only.error());
  writer->video_only_ = std::move(*video_only);
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
  encoder_.reset();  // before the set removes its file
}

Result<void> VideoWriter::add(const Image8& frame) {
  std::size_t sent = 0;
  while (sent < frame.data.size()) {
    const ssize_t n = send(socket_, frame.data.data() + sent, frame.data.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const auto ended = encoder_->wait();
      return encoder_error(target_, "the video encoder stopped", ended);
    }
    sent += std::size_t(n);
  }
  return {};
}

Result<fs::path> VideoWriter::finish(const fs::path& wav) {
  close(socket_);
  socket_ = -1;
  if (auto encoded = encoder_->wait(); !encoded)
    return encoder_error(target_, "the video encoder failed", encoded);
  auto joining = Process::start(
      ffmpeg_, {"-v", "error", "-y", "-i", video_only_.string(), "-i", wav.string(), "-c:v", "copy", "-c:a",
                "aac", "-b:a", "192k", "-movflags", "+faststart", muxed_.string()});
  if (!joining) return tl::unexpected(joining.error());
  if (auto joined = joining->wait(); !joined)
    return encoder_error(target_, "muxing picture and sound failed", joined);
  return muxed_;
}

Result<fs::path> VideoWriter::finish(std::span<const float> stereo, int sample_rate) {
  const auto wav = files_.add_scratch(fs::path(target_).concat(".wav"));
  if (!wav) return tl::unexpected(wav.error());
  if (auto filled = sound::fill_wav(*wav, target_, stereo, sample_rate, {.channels = 2}); !filled)
    return tl::unexpected(filled.error());
  return finish(*wav);
}

}  // namespace intaglio::session
