#include "session/video.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "core/file.h"
#include "sound/audio/wav.h"

namespace intaglio::session {

namespace fs = std::filesystem;

namespace {

// Ends of the names of a video's temporaries, after the video's own.
constexpr std::string_view picture_suffix = ".picture.mp4", sound_suffix = ".sound-";

// ffmpeg says why it failed in the last line of its standard error.
tl::unexpected<Error> encoder_error(const fs::path& target, const std::string& what,
                                    const Result<void>& ended) {
  const std::string reason = ended ? "" : ended.error().message();
  if (reason.find(std::strerror(ENOSPC)) != std::string::npos)
    return tl::unexpected(write_error(target, ENOSPC));
  return fail(target.string(), reason.empty() ? what : what + ": " + reason, "is the disk full?");
}

// Joins an MP4 without sound and a sound file, if there is one, into another MP4. With a raw_rate the sound
// is plain 32-bit floats, cut or padded with silence to the picture's length.
Result<void> mux(const fs::path& ffmpeg, const fs::path& target, const fs::path& picture,
                 const fs::path& sound, int raw_rate, const fs::path& to) {
  std::vector<std::string> arguments{"-v", "error", "-y", "-i", picture.string()};
  if (!sound.empty()) {
    if (raw_rate > 0)
      arguments.insert(arguments.end(), {"-f", "f32le", "-ar", std::to_string(raw_rate), "-ac", "2"});
    arguments.insert(arguments.end(), {"-i", sound.string(), "-c:a", "aac", "-b:a", "192k"});
    if (raw_rate > 0) arguments.insert(arguments.end(), {"-af", "apad", "-shortest"});
  }
  arguments.insert(arguments.end(), {"-c:v", "copy", "-movflags", "+faststart", to.string()});
  auto joining = Process::start(ffmpeg, arguments);
  if (!joining) return tl::unexpected(joining.error());
  if (auto joined = joining->wait(); !joined)
    return encoder_error(target, "muxing picture and sound failed", joined);
  return {};
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
                                                         const VideoFormat& format) {
  const auto ffmpeg = find_ffmpeg();
  if (!ffmpeg) return tl::unexpected(ffmpeg.error());
  if (auto named = check_extension(target, ".mp4", "an MP4"); !named) return tl::unexpected(named.error());
  std::unique_ptr<VideoWriter> writer(new VideoWriter(files, format));
  writer->ffmpeg_ = *ffmpeg;
  writer->target_ = target;
  auto muxed = files.add(target);
  if (!muxed) return tl::unexpected(muxed.error());
  writer->muxed_ = std::move(*muxed);
  auto video_only = files.add_scratch(fs::path(target).concat(picture_suffix));
  if (!video_only) return tl::unexpected(video_only.error());
  writer->video_only_ = std::move(*video_only);
  if (format.sound_rate > 0) {
    auto sound =
        files.add_scratch(fs::path(target).concat(fmt::format("{}{}.f32", sound_suffix, format.sound_rate)));
    if (!sound) return tl::unexpected(sound.error());
    writer->sound_ = std::move(*sound);
  }
  // A socket rather than a pipe: when the encoder dies, writing to a pipe raises SIGPIPE in the host.
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return fail(target.string(), std::string("no socket to the encoder: ") + std::strerror(errno));
  writer->socket_ = ends[1];
  SpawnOptions options;
  options.input = ends[0];
  std::vector<std::string> arguments{"-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s"};
  arguments.push_back(fmt::format("{}x{}", format.width, format.height));
  arguments.insert(arguments.end(), {"-r", std::to_string(format.fps), "-i", "pipe:0", "-an"});
  arguments.insert(arguments.end(), {"-c:v", "libx264", "-preset", "veryfast", "-crf", "18"});
  arguments.insert(arguments.end(), {"-threads", "1", "-pix_fmt", "yuv420p"});
  if (format.sound_rate > 0) {
    arguments.insert(arguments.end(), {"-movflags", "+empty_moov+default_base_moof", "-frag_duration",
                                       "250000", "-flush_packets", "1"});
  }
  arguments.push_back(writer->video_only_.string());
  auto process = Process::start(writer->ffmpeg_, arguments, options);
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

Result<void> VideoWriter::add_sound(std::span<const float> stereo) {
  const int file = open(sound_.c_str(), O_WRONLY | O_APPEND | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return tl::unexpected(write_error(target_, errno));
  const int reason = write_fully(file, {reinterpret_cast<const char*>(stereo.data()), stereo.size_bytes()});
  close(file);
  if (reason != 0) return tl::unexpected(write_error(target_, reason));
  return {};
}

Result<fs::path> VideoWriter::finish(const fs::path& sound, int raw_rate) {
  close(socket_);
  socket_ = -1;
  if (auto encoded = encoder_->wait(); !encoded)
    return encoder_error(target_, "the video encoder failed", encoded);
  if (auto muxed = mux(ffmpeg_, target_, video_only_, sound, raw_rate, muxed_); !muxed)
    return tl::unexpected(muxed.error());
  return muxed_;
}

Result<fs::path> VideoWriter::finish() {
  std::error_code error;
  const bool is_silent = fs::file_size(sound_, error) == 0;
  // An empty file would be no sound at all, where a video of silence is meant.
  if (is_silent) {
    const std::array<float, 2> silence{};
    if (auto added = add_sound(silence); !added) return tl::unexpected(added.error());
  }
  return finish(sound_, format_.sound_rate);
}

Result<fs::path> VideoWriter::finish(const fs::path& wav) {
  return finish(wav, 0);
}

Result<fs::path> VideoWriter::finish(std::span<const float> stereo, int sample_rate) {
  const auto wav = files_.add_scratch(fs::path(target_).concat(".wav"));
  if (!wav) return tl::unexpected(wav.error());
  if (auto filled = sound::fill_wav(*wav, target_, stereo, sample_rate, {.channels = 2}); !filled)
    return tl::unexpected(filled.error());
  return finish(*wav);
}

namespace {

// The duration in an MP4's header, which ffmpeg puts first (+faststart): version 0 of `mvhd`, seconds; 0
// where there is none.
double mp4_seconds(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);  // Trusted: ffmpeg has just written it; any bytes give a number
  std::string head(4096, '\0');
  in.read(head.data(), std::streamsize(head.size()));
  const std::size_t at = head.find("mvhd");
  if (at == std::string::npos || at + 24 > head.size()) return 0;
  const auto number = [&](std::size_t from) {
    double value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = 256 * value + double(std::uint8_t(head[from + k]));
    return value;
  };
  const double units = number(at + 16);
  return units > 0 ? number(at + 20) / units : 0;
}

Result<RecoveredVideo> recover(fs::path target, const StaleTemporary& picture, const StaleTemporary* sound,
                               int rate) {
  const auto ffmpeg = find_ffmpeg();
  if (!ffmpeg) return tl::unexpected(ffmpeg.error());
  std::error_code error;
  if (fs::exists(target, error)) target.replace_extension("recovered.mp4");
  OutputFiles files;
  const auto muxed = files.add(target);
  if (!muxed) return tl::unexpected(muxed.error());
  const fs::path file = sound != nullptr ? sound->path() : fs::path();
  if (auto done = mux(*ffmpeg, target, picture.path(), file, rate, *muxed); !done)
    return tl::unexpected(done.error());
  const double seconds = mp4_seconds(*muxed);
  if (auto committed = files.commit(); !committed) return tl::unexpected(committed.error());
  return RecoveredVideo{target, seconds};
}

}  // namespace

std::vector<Result<RecoveredVideo>> recover_videos(const fs::path& folder) {
  std::vector<StaleTemporary> stale = claim_stale_temporaries(folder);
  std::vector<Result<RecoveredVideo>> recovered;
  std::set<std::string> kept;
  for (const StaleTemporary& picture : stale) {
    std::error_code error;
    if (!picture.target().ends_with(picture_suffix) || fs::file_size(picture.path(), error) == 0) continue;
    const std::string name = picture.target().substr(0, picture.target().size() - picture_suffix.size());
    const StaleTemporary* sound = nullptr;
    for (const StaleTemporary& other : stale)
      if (other.target().starts_with(name + std::string(sound_suffix))) sound = &other;
    // Without a file for the sound it is another job's, such as a render's, which starts anew.
    if (sound == nullptr) continue;
    const int rate = std::atoi(sound->target().c_str() + name.size() + sound_suffix.size());
    const bool is_silent = rate <= 0 || fs::file_size(sound->path(), error) == 0;
    recovered.push_back(recover(folder / name, picture, is_silent ? nullptr : sound, rate));
    if (!recovered.back()) kept.insert({picture.target(), sound->target()});
  }
  for (StaleTemporary& one : stale)
    if (!kept.contains(one.target())) one.remove();
  return recovered;
}

}  // namespace intaglio::session
