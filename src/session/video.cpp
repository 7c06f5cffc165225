#include "session/video.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "core/file.h"

extern char** environ;

namespace intaglio::session {

namespace fs = std::filesystem;

namespace {

// Starts a program with `stdin_fd` as its standard input (-1: none) and our stderr. Returns its process id.
Result<pid_t> start(const std::vector<std::string>& command, int stdin_fd) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (stdin_fd >= 0) {
    posix_spawn_file_actions_adddup2(&actions, stdin_fd, STDIN_FILENO);
  } else {
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  }
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t process = -1;
  const int error =
      posix_spawn(&process, command.front().c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return fail(command.front(), std::string("cannot be started: ") + std::strerror(error));
  return process;
}

// Waits for a process to end; whether it exited with status 0.
bool exited_successfully(pid_t process) {
  int status = 0;
  pid_t ended;
  while ((ended = waitpid(process, &status, 0)) < 0 && errno == EINTR) {
  }
  // A host that ignores SIGCHLD loses the exit status: that counts as failure.
  return ended == process && WIFEXITED(status) && WEXITSTATUS(status) == 0;
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

Result<std::unique_ptr<VideoWriter>> VideoWriter::create(const fs::path& target, int width, int height,
                                                         int fps) {
  const auto ffmpeg = find_ffmpeg();
  if (!ffmpeg) return tl::unexpected(ffmpeg.error());
  if (auto named = check_named(target, ".mp4", "an MP4"); !named) return tl::unexpected(named.error());
  if (auto writable = check_writable(target); !writable) return tl::unexpected(writable.error());

  std::unique_ptr<VideoWriter> writer(new VideoWriter);
  writer->ffmpeg_ = *ffmpeg;
  writer->target_ = target;
  for (fs::path* const file : {&writer->video_only_, &writer->muxed_}) {
    auto temporary = temporary_for(target);
    if (!temporary) return tl::unexpected(temporary.error());
    *file = std::move(*temporary);
  }
  // A socket, not a pipe: sending to an encoder that died is then an error and no SIGPIPE.
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return fail(target.string(), std::string("no socket to the encoder: ") + std::strerror(errno));
  writer->socket_ = ends[1];
  const auto process = start({writer->ffmpeg_.string(),
                              "-v",
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
                             ends[0]);
  close(ends[0]);
  if (!process) return tl::unexpected(process.error());
  writer->encoder_ = *process;
  return writer;
}

VideoWriter::~VideoWriter() {
  if (socket_ >= 0) close(socket_);
  if (encoder_ > 0) exited_successfully(encoder_);
  std::error_code ignored;
  fs::remove(video_only_, ignored);
  fs::remove(muxed_, ignored);
}

Result<void> VideoWriter::add(const Image8& frame) {
  std::size_t sent = 0;
  while (sent < frame.data.size()) {
    const ssize_t n = send(socket_, frame.data.data() + sent, frame.data.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      return fail(target_.string(), "the video encoder stopped (its message is above)", "is the disk full?");
    sent += std::size_t(n);
  }
  return {};
}

Result<void> VideoWriter::finish(const fs::path& wav) {
  close(socket_);
  socket_ = -1;
  const bool encoded = exited_successfully(encoder_);
  encoder_ = -1;
  if (!encoded)
    return fail(target_.string(), "the video encoder failed (its message is above)", "is the disk full?");
  const auto process =
      start({ffmpeg_.string(), "-v", "error", "-y", "-i", video_only_.string(), "-i", wav.string(), "-c:v",
             "copy", "-c:a", "aac", "-b:a", "192k", "-movflags", "+faststart", muxed_.string()},
            -1);
  if (!process) return tl::unexpected(process.error());
  if (!exited_successfully(*process))
    return fail(target_.string(), "muxing picture and sound failed (ffmpeg's message is above)");
  std::error_code error;
  fs::rename(muxed_, target_, error);
  if (error) return fail(target_.string(), "cannot be replaced: " + error.message());
  return {};
}

}  // namespace intaglio::session
