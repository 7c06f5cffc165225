#include "intaglio/window/file_watch.h"

#include <algorithm>

namespace intaglio::window {

namespace fs = std::filesystem;

void FileWatch::watch(std::vector<fs::path> paths) {
  paths_ = std::move(paths);
  seen_ = times();
}

bool FileWatch::has_changed(double now) {
  if (now < next_) return false;
  next_ = now + 0.5;
  auto found = times();
  if (found == seen_) return false;
  seen_ = std::move(found);
  return true;
}

std::vector<FileWatch::Time> FileWatch::times() const {
  std::vector<Time> found;
  std::error_code ignored;
  for (const fs::path& path : paths_) {
    Time newest = fs::last_write_time(path, ignored);
    if (fs::is_directory(path, ignored))
      for (const auto& entry : fs::directory_iterator(path, ignored))
        newest = std::max(newest, fs::last_write_time(entry.path(), ignored));
    found.push_back(newest);
  }
  return found;
}

}  // namespace intaglio::window
