// Files that a job writes, put in place together: until commit() the old ones stand untouched, and an error,
// an exception or a crash on the way leaves them as they were.
//
//   OutputFiles files;
//   if (auto written = files.write("out/a.csv", text); !written) return written;
//   const auto video = files.add("out/a.mp4");  // a program writes to *video
//   ...
//   return files.commit();
//
// Every file is written to a temporary in its target's folder, `.NAME.intaglio-XXXXXXXXCCCC.part.EXT`: X is
// random, C a checksum of the rest, so that no file of the user's is taken for one of ours, and the extension
// stays, because programs choose a format by it. A temporary is always a new file (an existing file or link
// of its name is neither opened nor replaced) and is locked by flock() while its process lives. The leftovers
// of a killed process are thus recognised with certainty, and removed when their target is written next.
//
// The target: a regular file or none, not a device or pipe. A symbolic link is followed, and the file that it
// names is replaced; other hard links to that file keep the old content. A file that the user has made
// read-only is refused. A replaced file keeps its permissions, and its owner where that is allowed; a new one
// gets 0666 less the umask.
//
// commit() writes everything through to the disk, then renames. Where a rename fails, the earlier ones are
// undone: the old files wait under the temporaries' names until the last new one is in place
// (RENAME_EXCHANGE; on a file system without it, such as NFS, a replaced file cannot be put back). Two
// processes that commit into one folder do so one after the other, so that their sets do not mix. Only a
// crash of the machine or a SIGKILL between the renames, which take microseconds, can leave a set half new;
// each file is whole even then.
//
// Cost: a look through the target's folder, an fsync a file, and a descriptor a file until commit(). One
// thread at a time. Linux.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "intaglio/error.h"

namespace intaglio {

struct AbandonedOutputs {
  std::size_t committed = 0;  // files that this process has put in place since it began
  std::size_t kept = 0;       // sets whose temporaries are kept
};

class OutputFiles {
 public:
  // Whether abandon_outputs() removes the temporaries. Recordings are kept, for what can be saved of them.
  enum class WhenStopped { remove, keep };

  explicit OutputFiles(WhenStopped when_stopped = WhenStopped::remove);
  ~OutputFiles();  // removes what was not committed
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  // Creates the target's folder and an empty temporary, whose absolute path is returned: the caller, or a
  // program that it starts, writes to it and closes it before commit(). Errors: a target that cannot be
  // replaced, an unwritable folder, a file that is in the set already.
  Result<std::filesystem::path> add(const std::filesystem::path& target);
  // A temporary that is only needed on the way, such as a video still without sound: commit() removes it. Its
  // name and folder are those of a file beside which it goes, whatever is there.
  Result<std::filesystem::path> add_scratch(const std::filesystem::path& beside);

  // Adds a file and writes it.
  Result<void> write(const std::filesystem::path& target, std::span<const std::uint8_t> bytes);
  Result<void> write(const std::filesystem::path& target, std::string_view text);

  // Puts all files in place, or none; the set is empty afterwards, or still removed as a whole.
  Result<void> commit();

 private:
  // Where the file is: `written`, at the temporary's name; `replaced`, at the target, and the old file at the
  // temporary's name; `placed`, at the target, and nothing at the temporary's name.
  enum class State { written, replaced, placed };
  struct File {
    std::filesystem::path name;               // as the caller gave it, for messages
    std::filesystem::path target, temporary;  // absolute, without links
    int descriptor = -1, old = -1;            // hold the locks: of the temporary, of the replaced file
    bool is_scratch = false;
    State state = State::written;
    struct Permissions {
      mode_t mode;
      uid_t user;
      gid_t group;
    };
    std::optional<Permissions> kept;  // the permissions of the replaced file
  };

  Result<std::filesystem::path> create(const std::filesystem::path& target, bool is_scratch);
  static Result<void> flush(const File& file);
  static Result<void> put_in_place(File& file, bool is_alone);
  Result<void> put_all_in_place(bool is_alone);
  std::string undo();
  void remove_temporaries() const;
  void clear();
  friend AbandonedOutputs abandon_outputs();

  WhenStopped when_stopped_;
  std::vector<File> files_;
};

// A temporary that a dead process left. While this object lives, no other process claims or removes it.
class StaleTemporary {
 public:
  // Nothing where `path` is not such a file, or where another process holds it.
  static std::optional<StaleTemporary> claim(const std::filesystem::path& path);
  StaleTemporary(StaleTemporary&& other) noexcept;
  StaleTemporary& operator=(StaleTemporary&& other) noexcept;
  ~StaleTemporary();

  const std::filesystem::path& path() const { return path_; }
  // The name of the file beside which it was made; names of over 190 bytes are cut.
  const std::string& target() const { return target_; }
  void remove();

 private:
  StaleTemporary() = default;

  std::filesystem::path path_;
  std::string target_;
  int descriptor_ = -1;
};

// All that dead processes left in a folder. The next write of the same target removes them by itself; where
// each file gets a new name, as recordings do, somebody has to look.
std::vector<StaleTemporary> claim_stale_temporaries(const std::filesystem::path& folder);

// For a program that ends next, in whatever state its threads are: waits until no set is being put in place,
// then removes the temporaries of all sets of this process. From then on no thread that adds or commits files
// returns.
AbandonedOutputs abandon_outputs();

// The error of a write that failed with `reason`, an errno; a full disk is named as such.
Error write_error(const std::filesystem::path& path, int reason);

}  // namespace intaglio
