#include "core/output_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "core/file.h"
#include "core/hash.h"

namespace intaglio {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view temporary_mark = ".intaglio-", temporary_part = ".part";
constexpr std::size_t digits_random = 8, digits_check = 4;
constexpr std::size_t longest_name = 190, longest_extension = 20;  // of 255 bytes that a name may have

// As much of a target's name as a temporary's has room for; UTF-8 is not cut within a character.
std::string name_in_temporary(const std::string& target) {
  if (target.size() <= longest_name) return target;
  std::size_t size = longest_name;
  while (size > 0 && (std::uint8_t(target[size]) & 0xc0) == 0x80) --size;
  return target.substr(0, size);
}

std::string temporary_name(const std::string& name, const std::string& random, const std::string& extension) {
  Hash hash;
  for (const std::string* part : {&name, &random, &extension}) hash.add(std::string_view(*part));
  const std::uint64_t mixed = hash.value() ^ (hash.value() >> 32);
  return fmt::format(".{}{}{}{:04x}{}{}", name, temporary_mark, random, (mixed ^ (mixed >> 16)) & 0xffff,
                     temporary_part, extension);
}

// The target's name in a temporary's, or an empty one where `name` is not a temporary's of ours.
std::string target_of(const std::string& name) {
  const std::size_t mark = name.rfind(temporary_mark);
  if (mark == std::string::npos || mark < 2) return "";
  const std::size_t random = mark + temporary_mark.size();
  const std::size_t end = random + digits_random + digits_check + temporary_part.size();
  if (end > name.size()) return "";
  const std::string target = name.substr(1, mark - 1);
  const bool is_ours = name == temporary_name(target, name.substr(random, digits_random), name.substr(end));
  return is_ours ? target : "";
}

bool is_same_file(int descriptor, const fs::path& path) {
  struct stat opened {
  }, named{};
  return fstat(descriptor, &opened) == 0 && lstat(path.c_str(), &named) == 0 && S_ISREG(named.st_mode) &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

// The temporaries in a folder, whether their processes live or not.
std::vector<fs::path> temporaries_in(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> found;
  for (auto at = fs::directory_iterator(folder, error); !error && at != fs::end(at); at.increment(error)) {
    if (!target_of(at->path().filename().string()).empty()) found.push_back(at->path());
  }
  return found;
}

void remove_stale_of(const fs::path& folder, const std::string& target) {
  for (const fs::path& path : temporaries_in(folder)) {
    if (target_of(path.filename().string()) != name_in_temporary(target)) continue;
    if (auto stale = StaleTemporary::claim(path)) stale->remove();
  }
}

// The file that `name` leads to, which may not exist yet. The kernel follows the links first, so that those
// which it refuses to follow (of other users in a shared folder) are refused here too.
Result<fs::path> follow_links(const fs::path& name) {
  struct stat target {};
  if (stat(name.c_str(), &target) != 0 && errno != ENOENT && errno != ENOTDIR)
    return fail(name.string(), std::string("cannot be written: ") + std::strerror(errno),
                "name another file");
  fs::path path = name;
  std::error_code error;
  for (int links = 0; fs::is_symlink(fs::symlink_status(path, error)); ++links) {
    const fs::path next = fs::read_symlink(path, error);
    if (error || links >= 40)
      return fail(name.string(), "is a symbolic link that leads nowhere", "name a file");
    path = path.parent_path() / next;
  }
  return path;
}

Result<void> check_target(const fs::path& name) {
  if (!name.has_filename())
    return fail(name.empty() ? "\"\"" : name.string(), "is not a file name", "name a file");
  struct stat target {};
  if (stat(name.c_str(), &target) != 0) return {};
  if (S_ISDIR(target.st_mode)) return fail(name.string(), "is a folder", "name a file");
  if (!S_ISREG(target.st_mode)) return fail(name.string(), "is a device or pipe, not a file", "name a file");
  if (faccessat(AT_FDCWD, name.c_str(), W_OK, AT_EACCESS) != 0)
    return fail(name.string(), "is read-only", "make it writable, or name another file");
  return {};
}

Result<void> make_folder(const fs::path& name, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    return fail(name.string(), "cannot create its folder: " + error.message(), "choose a writable location");
  return {};
}

std::optional<std::string> random_digits() {
  std::uint32_t number = 0;
  if (getrandom(&number, sizeof number, 0) != sizeof number) return std::nullopt;
  return fmt::format("{:08x}", number);
}

// A new file that only this process has, locked: its path and descriptor, or an errno.
tl::expected<std::pair<fs::path, int>, int> create_temporary(const fs::path& target, mode_t mode) {
  const std::string name = name_in_temporary(target.filename().string());
  std::string extension = target.extension().string();
  if (extension.size() > longest_extension) extension.clear();
  for (int attempt = 0; attempt < 100; ++attempt) {
    const auto random = random_digits();
    if (!random) return tl::unexpected(errno);
    const fs::path path = target.parent_path() / temporary_name(name, *random, extension);
    const int file = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    if (file < 0 && errno == EEXIST) continue;
    if (file < 0) return tl::unexpected(errno);
    // A file system without locks has no stale temporaries either: none can be known as such.
    const bool is_taken = flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (!is_taken && is_same_file(file, path)) return std::pair(path, file);
    close(file);  // another process took it for a stale one before it was locked
  }
  return tl::unexpected(EEXIST);
}

// The folders of a set, locked while its files are renamed. A lock that somebody else holds for long, such as
// a script by flock(1), must not stop us: then two sets might mix, but no file is torn.
class LockedFolders {
 public:
  LockedFolders(std::vector<fs::path> folders, bool lock) {
    std::sort(folders.begin(), folders.end());  // one order for all processes, so that none waits for another
    folders.erase(std::unique(folders.begin(), folders.end()), folders.end());
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    for (const fs::path& folder : folders) {
      const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
      if (opened < 0) continue;
      opened_.push_back(opened);
      while (lock && flock(opened, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK &&
             std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  LockedFolders(const LockedFolders&) = delete;
  LockedFolders& operator=(const LockedFolders&) = delete;
  ~LockedFolders() {
    for (const int folder : opened_) close(folder);
  }
  // Failing means that a power cut may still undo the renames; the files are in place, so it is no error.
  void flush() const {
    for (const int folder : opened_) fsync(folder);
  }

 private:
  std::vector<int> opened_;
};

bool exchange(const fs::path& a, const fs::path& b) {
  return renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

// The sets that have temporaries or may get some. Locked while a temporary appears or vanishes and while
// files are renamed. Never destroyed: it is used while the program ends.
struct Live {
  std::timed_mutex mutex;
  std::vector<OutputFiles*> sets;
  std::size_t committed = 0;  // files
};

Live& live() {
  static Live& all = *new Live;
  return all;
}

using LiveLock = std::lock_guard<std::timed_mutex>;

}  // namespace

Error write_error(const fs::path& path, int reason) {
  if (reason == ENOSPC) return {path.string(), "disk full", "free some space, or write to another disk"};
  if (reason == EDQUOT)
    return {path.string(), "disk full: your quota is used up", "free some space, or write to another disk"};
  if (reason == EFBIG)
    return {path.string(), "is larger than a file may be here", "see ulimit -f and the file system's limit"};
  if (reason == EMFILE)
    return {path.string(), "too many files are open", "raise the limit (ulimit -n), or write fewer files"};
  return {path.string(), std::string("cannot be written: ") + std::strerror(reason),
          "choose a writable location"};
}

// Never waits, whatever is at that name.
std::optional<StaleTemporary> StaleTemporary::claim(const fs::path& path) {
  struct stat found {};
  if (lstat(path.c_str(), &found) != 0 || !S_ISREG(found.st_mode) || found.st_uid != geteuid())
    return std::nullopt;
  StaleTemporary stale;
  stale.target_ = target_of(path.filename().string());
  if (stale.target_.empty()) return std::nullopt;
  stale.path_ = path;
  stale.descriptor_ = open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (stale.descriptor_ < 0 || flock(stale.descriptor_, LOCK_EX | LOCK_NB) != 0 ||
      !is_same_file(stale.descriptor_, path))
    return std::nullopt;
  return stale;
}

StaleTemporary::StaleTemporary(StaleTemporary&& other) noexcept {
  *this = std::move(other);
}

StaleTemporary& StaleTemporary::operator=(StaleTemporary&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(target_, other.target_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

StaleTemporary::~StaleTemporary() {
  if (descriptor_ >= 0) close(descriptor_);
}

// The lock is held while the name is removed: a process that has just created the file but not locked it yet
// finds it locked or gone, and takes another name.
void StaleTemporary::remove() {
  if (is_same_file(descriptor_, path_)) unlink(path_.c_str());
}

std::vector<StaleTemporary> claim_stale_temporaries(const fs::path& folder) {
  std::vector<StaleTemporary> claimed;
  for (const fs::path& path : temporaries_in(folder.empty() ? fs::path(".") : folder)) {
    if (auto stale = StaleTemporary::claim(path)) claimed.push_back(std::move(*stale));
  }
  return claimed;
}

OutputFiles::OutputFiles(WhenStopped when_stopped) : when_stopped_(when_stopped) {
  const LiveLock lock(live().mutex);
  live().sets.push_back(this);
}

OutputFiles::~OutputFiles() {
  const LiveLock lock(live().mutex);
  std::erase(live().sets, this);
  clear();
}

// Removes what is at the temporaries' names, except old files that could not be put back.
void OutputFiles::remove_temporaries() const {
  for (const File& file : files_) {
    if (file.state == State::written && is_same_file(file.descriptor, file.temporary))
      unlink(file.temporary.c_str());
  }
}

void OutputFiles::clear() {
  remove_temporaries();
  for (const File& file : files_) {
    close(file.descriptor);
    if (file.old >= 0) close(file.old);
  }
  files_.clear();
}

Result<fs::path> OutputFiles::create(const fs::path& target, bool is_scratch) {
  Result<fs::path> followed = target;
  if (!is_scratch) {
    if (auto checked = check_target(target); !checked) return tl::unexpected(checked.error());
    followed = follow_links(target);
    if (!followed) return tl::unexpected(followed.error());
  }
  const fs::path folder = followed->has_parent_path() ? followed->parent_path() : fs::path(".");
  if (auto made = make_folder(target, folder); !made) return tl::unexpected(made.error());
  std::error_code error;
  const fs::path absolute = fs::canonical(folder, error);
  if (error) return tl::unexpected(write_error(target, error.value()));
  File file;
  file.name = target;
  file.target = absolute / followed->filename();
  file.is_scratch = is_scratch;
  for (const File& other : files_) {
    if (!is_scratch && !other.is_scratch && other.target == file.target)
      return fail(target.string(), "is the same file as " + other.name.string(), "name different files");
  }
  remove_stale_of(absolute, file.target.filename().string());
  struct stat old {};
  if (!is_scratch && lstat(file.target.c_str(), &old) == 0)
    file.kept = {old.st_mode & 07777, old.st_uid, old.st_gid};
  // Private until commit(): the file that it replaces may be one that others cannot read.
  const LiveLock lock(live().mutex);
  const auto temporary = create_temporary(file.target, file.kept ? 0600 : 0666);
  if (!temporary) return tl::unexpected(write_error(target, temporary.error()));
  std::tie(file.temporary, file.descriptor) = *temporary;
  files_.push_back(std::move(file));
  return files_.back().temporary;
}

Result<fs::path> OutputFiles::add(const fs::path& target) {
  return create(target, false);
}

Result<fs::path> OutputFiles::add_scratch(const fs::path& target) {
  return create(target, true);
}

Result<void> OutputFiles::write(const fs::path& target, std::string_view text) {
  if (const auto added = add(target); !added) return tl::unexpected(added.error());
  if (const int reason = write_fully(files_.back().descriptor, text); reason != 0)
    return tl::unexpected(write_error(target, reason));
  return {};
}

Result<void> OutputFiles::write(const fs::path& target, std::span<const std::uint8_t> bytes) {
  return write(target, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

// Gives the new file the old one's permissions and writes it through to the disk.
Result<void> OutputFiles::flush(const File& file) {
  if (!is_same_file(file.descriptor, file.temporary))
    return fail(file.name.string(), "its temporary file was removed or replaced by another program",
                "run it again");
  if (file.kept) {
    // Only root may give a file away; everyone else's own files are theirs already.
    struct stat now {};
    if (fstat(file.descriptor, &now) == 0 &&
        (now.st_uid != file.kept->user || now.st_gid != file.kept->group))
      (void)!fchown(file.descriptor, file.kept->user, file.kept->group);
    if (fchmod(file.descriptor, file.kept->mode) != 0) return tl::unexpected(write_error(file.name, errno));
  }
  if (fsync(file.descriptor) != 0) return tl::unexpected(write_error(file.name, errno));
  return {};
}

Result<void> OutputFiles::put_in_place(File& file, bool is_alone) {
  const auto no_file = [&] {
    return fail(file.name.string(), "is no longer a file: another program has replaced it", "run it again");
  };
  struct stat found {};
  if (lstat(file.target.c_str(), &found) == 0 && !S_ISREG(found.st_mode)) return no_file();
  if (!is_alone) {
    // Locked like a temporary, because it takes a temporary's name for a moment.
    if (file.old < 0) file.old = open(file.target.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file.old >= 0) (void)flock(file.old, LOCK_EX | LOCK_NB);
    if (exchange(file.temporary, file.target)) {
      file.state = State::replaced;
      if (lstat(file.temporary.c_str(), &found) == 0 && S_ISREG(found.st_mode)) return {};
      if (exchange(file.temporary, file.target)) file.state = State::written;
      return no_file();
    }
    const bool can_rename = errno == ENOENT || errno == EINVAL || errno == ENOSYS || errno == EOPNOTSUPP;
    if (!can_rename) return tl::unexpected(write_error(file.name, errno));
  }
  if (std::rename(file.temporary.c_str(), file.target.c_str()) != 0)
    return tl::unexpected(write_error(file.name, errno));
  file.state = State::placed;
  return {};
}

// Puts the old files back, the last one first. Returns what could not be undone, for the error.
std::string OutputFiles::undo() {
  std::string failed;
  for (auto file = files_.rbegin(); file != files_.rend(); ++file) {
    if (file->state == State::written) continue;
    // A file that was not there before is taken away; one that no exchange could replace stays new.
    const bool was_replaced = file->state == State::placed && file->kept;
    const bool is_undone =
        !was_replaced &&
        (file->state == State::replaced ? exchange(file->temporary, file->target)
                                        : std::rename(file->target.c_str(), file->temporary.c_str()) == 0);
    if (is_undone) {
      file->state = State::written;
    } else {
      failed += fmt::format("; {} is new already", file->name.string());
      if (file->state == State::replaced)
        failed += fmt::format(", its old content is in {}", file->temporary.string());
    }
  }
  return failed;
}

Result<void> OutputFiles::commit() {
  std::vector<fs::path> folders;
  for (const File& file : files_) {
    if (file.is_scratch) continue;
    if (auto flushed = flush(file); !flushed) return flushed;
    folders.push_back(file.target.parent_path());
  }
  const bool is_alone = folders.size() == 1;
  const std::size_t count = folders.size();
  const LockedFolders locked(std::move(folders), !is_alone);
  {
    const LiveLock lock(live().mutex);
    if (auto placed = put_all_in_place(is_alone); !placed) return placed;
    live().committed += count;
    clear();
  }
  locked.flush();
  return {};
}

Result<void> OutputFiles::put_all_in_place(bool is_alone) {
  for (File& file : files_) {
    if (file.is_scratch) continue;
    if (auto placed = put_in_place(file, is_alone); !placed) {
      placed.error().what += undo();
      return placed;
    }
  }
  for (File& file : files_) {
    if (file.state == State::replaced) unlink(file.temporary.c_str());
  }
  return {};
}

AbandonedOutputs abandon_outputs() {
  Live& all = live();
  // Never unlocked. Where renaming takes longer than any disk does, its end is not waited for.
  if (!all.mutex.try_lock_for(std::chrono::seconds(2))) return {};
  AbandonedOutputs out{all.committed, 0};
  for (const OutputFiles* set : all.sets) {
    if (set->when_stopped_ == OutputFiles::WhenStopped::remove) {
      set->remove_temporaries();
    } else if (!set->files_.empty()) {
      ++out.kept;
    }
  }
  return out;
}

}  // namespace intaglio
