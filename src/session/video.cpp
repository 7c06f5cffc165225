#include "session/video.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>
#include <fmt/format.h>

#include "core/file.h"

extern char** environ;

namespace intaglio::session {

namespace fs = std::filesystem;

namespace {

// Starts a program with `input` as its standard input (-1: none) and its own messages on ours. Returns its
// process id.
Result<pid_t> start(const std::vector<std::string>& words, int input) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (input >= 0) {
    posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  } else {
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  }
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t process = -1;
  const int error =
      posix_spawn(&process, words.front().c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return fail(words.front(), std::string("cannot be started: ") + std::strerror(error));
  return process;
}

// Waits for the end of a process; whether it ended well.
bool ended_well(pid_t process) {
  int status = 0;
  pid_t ended;
  while ((ended = waitpid(process, &status, 0)) < 0 && errno == EINTR) {
  }
  // A host that ignores SIGCHLD loses the exit status: that counts as a failure.
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
  for (fs::path* const file : {&writer->silent_, &writer->joined_}) {
    auto temporary = temporary_for(target);
    if (!temporary) return tl::unexpected(temporary.error());
    *file = std::move(*temporary);
  }
  signal(SIGPIPE, SIG_IGN);  // an encoder that dies is an error of ours, not the end of us
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return fail(target.string(), std::string("no pipe to the encoder: ") + std::strerror(errno));
  writer->pipe_ = ends[1];
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
                              writer->silent_.string()},
                             ends[0]);
  close(ends[0]);
  if (!process) return tl::unexpected(process.error());
  writer->process_ = *process;
  return writer;
}

VideoWriter::~VideoWriter() {
  if (pipe_ >= 0) close(pipe_);
  if (process_ > 0) ended_well(process_);
  std::error_code ignored;
  fs::remove(silent_, ignored);
  fs::remove(joined_, ignored);
}

Result<void> VideoWriter::add(const Image8& frame) {
  std::size_t sent = 0;
  while (sent < frame.data.size()) {
    const ssize_t n = write(pipe_, frame.data.data() + sent, frame.data.size() - sent);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      return fail(target_.string(), "the video encoder stopped (its message is above)", "is the disk full?");
    sent += static_cast<std::size_t>(n);
  }
  return {};
}

Result<void> VideoWriter::finish(const fs::path& wav) {
  close(pipe_);
  pipe_ = -1;
  const bool encoded = ended_well(process_);
  process_ = -1;
  if (!encoded)
    return fail(target_.string(), "the video encoder failed (its message is above)", "is the disk full?");
  const auto process =
      start({ffmpeg_.string(), "-v", "error", "-y", "-i", silent_.string(), "-i", wav.string(), "-c:v",
             "copy", "-c:a", "aac", "-b:a", "192k", "-movflags", "+faststart", joined_.string()},
            -1);
  if (!process) return tl::unexpected(process.error());
  if (!ended_well(*process))
    return fail(target_.string(), "joining picture and sound failed (ffmpeg's message is above)");
  std::error_code error;
  fs::rename(joined_, target_, error);
  if (error) return fail(target_.string(), "cannot be replaced: " + error.message());
  return {};
}

}  // namespace intaglio::session
