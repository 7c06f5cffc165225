// Whether files have changed since they were last looked at: by their times, asked for twice a second. A
// folder counts with all files in it. One thread.
#pragma once

#include <filesystem>
#include <vector>

namespace intaglio::window {

class FileWatch {
 public:
  void watch(std::vector<std::filesystem::path> paths);
  // Whether anything has changed since watch() or the last change that was told, `now` in seconds.
  bool has_changed(double now);

 private:
  using Time = std::filesystem::file_time_type;
  std::vector<Time> times() const;

  std::vector<std::filesystem::path> paths_;
  std::vector<Time> seen_;
  double next_ = 0;
};

}  // namespace intaglio::window
