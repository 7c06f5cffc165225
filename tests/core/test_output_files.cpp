#include <doctest/doctest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/file.h"
#include "core/output_files.h"
#include "tests/skipped.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
namespace fs = std::filesystem;

namespace {

// Empty where there is no such file, so that it differs from every content.
std::optional<std::string> content(const fs::path& path) {
  auto text = read_text(path, 1u << 20);
  return text ? std::optional(std::move(*text)) : std::nullopt;
}

std::ptrdiff_t count_of(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

mode_t permissions(const fs::path& path) {
  struct stat found {};
  REQUIRE(stat(path.c_str(), &found) == 0);
  return found.st_mode & 07777;
}

// A temporary of `target` whose process has been killed.
fs::path stale_temporary(const fs::path& target) {
  fs::path name;
  {
    OutputFiles files;
    name = *files.add(target);
    fs::copy_file(name, name.string() + "-kept");
  }
  fs::rename(name.string() + "-kept", name);
  return name;
}

void remove_all_stale(const fs::path& folder) {
  for (StaleTemporary& stale : claim_stale_temporaries(folder)) stale.remove();
}

// Limits the size of files: writing beyond it fails as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : signal_(::signal(SIGXFSZ, SIG_IGN)) {
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before_) == 0);
    const rlimit limit{bytes, before_.rlim_max};
    REQUIRE(setrlimit(RLIMIT_FSIZE, &limit) == 0);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, signal_);
  }

 private:
  rlimit before_{};
  void (*signal_)(int);
};

}  // namespace

TEST_CASE("a set of files appears together, and not before it is committed") {
  const tests::TemporaryFolder folder;
  REQUIRE(write_file(folder.path / "b", "old b"));
  OutputFiles files;
  REQUIRE(files.write(folder.path / "a", "new a"));
  REQUIRE(files.write(folder.path / "b", "new b"));
  REQUIRE(files.write(folder.path / "deep" / "c", "new c"));
  const auto scratch = files.add_scratch(folder.path / "a");
  REQUIRE(scratch);
  CHECK_FALSE(content(folder.path / "a"));
  CHECK(content(folder.path / "b") == "old b");
  REQUIRE(files.commit());
  CHECK(content(folder.path / "a") == "new a");
  CHECK(content(folder.path / "b") == "new b");
  CHECK(content(folder.path / "deep" / "c") == "new c");
  CHECK(count_of(folder.path) == 3);
  CHECK(count_of(folder.path / "deep") == 1);
}

TEST_CASE("a set that is not committed leaves the old files and nothing else") {
  const tests::TemporaryFolder folder;
  REQUIRE(write_file(folder.path / "a", "old"));
  {
    OutputFiles files;
    REQUIRE(files.write(folder.path / "a", "new"));
    REQUIRE(files.write(folder.path / "b", "new"));
    REQUIRE(files.add_scratch(folder.path / "b"));
  }
  CHECK(content(folder.path / "a") == "old");
  CHECK(count_of(folder.path) == 1);
}

TEST_CASE("where one file cannot be put in place the others are put back") {
  for (const bool is_new : {false, true}) {
    const tests::TemporaryFolder folder;
    REQUIRE(write_file(folder.path / "a", "old a"));
    if (!is_new) REQUIRE(write_file(folder.path / "b", "old b"));
    {
      OutputFiles files;
      for (const char* name : {"a", "b", "c"}) REQUIRE(files.write(folder.path / name, "new"));
      REQUIRE(fs::create_directory(folder.path / "c"));
      const auto committed = files.commit();
      REQUIRE_FALSE(committed);
      CHECK(committed.error().message().find("c: is no longer a file") != std::string::npos);
      CHECK(content(folder.path / "a") == "old a");
      CHECK(content(folder.path / "b") == (is_new ? std::nullopt : std::optional<std::string>("old b")));
    }
    CHECK(fs::is_directory(folder.path / "c"));
    CHECK(count_of(folder.path) == (is_new ? 2 : 3));
  }
}

TEST_CASE("ten files are all old or all new, whichever of them finds the disk full") {
  const tests::TemporaryFolder folder;
  const int count = 10, step = 500;
  const auto file = [&](int k) { return folder.path / ("file" + std::to_string(k) + ".bin"); };
  const auto size = [&](int k) { return std::size_t(step) * std::size_t((7 * k) % count + 1); };
  int failures = 0;
  for (int limit = 0; limit <= count * step + 370; limit += 370) {
    for (int k = 0; k < count; ++k) REQUIRE(write_file(file(k), "old" + std::to_string(limit)));
    Result<void> written;
    {
      const FileSizeLimit full{rlim_t(limit)};
      OutputFiles files;
      for (int k = 0; k < count && written; ++k) written = files.write(file(k), std::string(size(k), 'n'));
      if (written) written = files.commit();
    }
    failures += written ? 0 : 1;
    if (!written) CHECK(written.error().message().find("is larger than a file may be") != std::string::npos);
    for (int k = 0; k < count; ++k)
      CHECK(content(file(k)) == (written ? std::string(size(k), 'n') : "old" + std::to_string(limit)));
    CHECK(count_of(folder.path) == count);
  }
  CHECK(failures > 10);
  CHECK(failures < 15);
}

TEST_CASE("files of the user's that resemble a temporary are left alone") {
  const tests::TemporaryFolder folder;
  const fs::path target = folder.path / "out.mp4";
  const std::string ours = stale_temporary(target).filename().string();
  fs::remove(folder.path / ours);
  std::string wrong = ours;  // one digit of the checksum
  char& digit = wrong[wrong.rfind(".part") - 1];
  digit = digit == '0' ? '1' : '0';
  std::vector<std::string> names{"out.part.mp4",
                                 "out.silent.mp4",
                                 "out.mp4.part",
                                 ".out.mp4.part.mp4",
                                 wrong,
                                 ours.substr(1),
                                 ours + ".bak",
                                 ".other" + ours.substr(4),
                                 ".intaglio-00000000.part",
                                 ".intaglio-000000000000.part"};
  for (const std::string& name : names) REQUIRE(write_file(folder.path / name, "mine"));
  fs::create_directory(folder.path / ours);
  REQUIRE(write_file(target, "new"));
  remove_all_stale(folder.path);
  for (const std::string& name : names) CHECK_MESSAGE(content(folder.path / name) == "mine", name);
  CHECK(fs::is_directory(folder.path / ours));
  fs::remove(folder.path / ours);
  REQUIRE(mkfifo((folder.path / ours).c_str(), 0600) == 0);
  REQUIRE(write_file(target, "newer"));
  CHECK(fs::is_fifo(folder.path / ours));
}

TEST_CASE(
    "a temporary of a dead process is removed when its target is written next, that of a live one is not") {
  const tests::TemporaryFolder folder;
  const fs::path target = folder.path / "out.mp4", other = folder.path / "other.mp4";
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    OutputFiles files;
    const bool is_written = bool(files.write(target, "of the child"));
    (void)!write(ends[1], is_written ? "1" : "0", 1);
    while (true) pause();
  }
  char is_written = '0';
  REQUIRE(read(ends[0], &is_written, 1) == 1);
  close(ends[0]);
  close(ends[1]);
  CHECK(is_written == '1');
  CHECK(count_of(folder.path) == 1);
  REQUIRE(write_file(target, "new"));
  remove_all_stale(folder.path);
  CHECK(count_of(folder.path) == 2);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  REQUIRE(write_file(other, "new"));  // another target: not its temporary
  CHECK(count_of(folder.path) == 3);
  REQUIRE(write_file(target, "newer"));
  CHECK(count_of(folder.path) == 2);
  CHECK(content(target) == "newer");
}

TEST_CASE("a claimed temporary is nobody else's, and knows its target") {
  const tests::TemporaryFolder folder;
  const fs::path stale = stale_temporary(folder.path / "out.mp4");
  {
    std::vector<StaleTemporary> claimed = claim_stale_temporaries(folder.path);
    REQUIRE(claimed.size() == 1);
    CHECK(claimed[0].target() == "out.mp4");
    CHECK(claimed[0].path() == stale);
    CHECK(claim_stale_temporaries(folder.path).empty());
    REQUIRE(write_file(folder.path / "out.mp4", "new"));
    CHECK(fs::exists(stale));
  }
  CHECK(claim_stale_temporaries(folder.path).size() == 1);
}

TEST_CASE("what dead processes left in a folder is removed whatever its target is") {
  const tests::TemporaryFolder folder;
  stale_temporary(folder.path / "a.mp4");
  stale_temporary(folder.path / "b");
  stale_temporary(folder.path / std::string(250, 'x'));
  OutputFiles files;
  REQUIRE(files.add(folder.path / "a.mp4"));
  CHECK(count_of(folder.path) == 3);  // a.mp4's went already
  remove_all_stale(folder.path);
  CHECK(count_of(folder.path) == 1);
}

TEST_CASE("a temporary has the target's extension, a name of its own and a place in the longest name") {
  const tests::TemporaryFolder folder;
  OutputFiles one, other;
  const auto a = one.add(folder.path / "x.wav"), b = other.add(folder.path / "x.wav");
  REQUIRE(a);
  REQUIRE(b);
  CHECK(*a != *b);
  CHECK(a->extension() == ".wav");
  CHECK(a->is_absolute());
  std::string longest;
  while (longest.size() < 250) longest += "ö";
  longest += ".html";
  REQUIRE(write_file(folder.path / longest, "x"));
  CHECK(content(folder.path / longest) == "x");
}

TEST_CASE("a link is followed to its file, and one at a temporary's name never") {
  const tests::TemporaryFolder folder;
  fs::create_directory(folder.path / "far");
  REQUIRE(write_file(folder.path / "far" / "real.txt", "old"));
  fs::create_symlink("far/real.txt", folder.path / "near.txt");
  fs::create_symlink("near.txt", folder.path / "nearer.txt");
  REQUIRE(write_file(folder.path / "nearer.txt", "new"));
  CHECK(content(folder.path / "far" / "real.txt") == "new");
  CHECK(fs::is_symlink(folder.path / "near.txt"));
  CHECK(fs::is_symlink(folder.path / "nearer.txt"));
  CHECK(count_of(folder.path / "far") == 1);
  fs::create_symlink("far/none.txt", folder.path / "dangling.txt");
  REQUIRE(write_file(folder.path / "dangling.txt", "made"));
  CHECK(content(folder.path / "far" / "none.txt") == "made");
  fs::create_symlink("loop", folder.path / "loop");
  CHECK_FALSE(write_file(folder.path / "loop", "x"));

  // A link to a victim at the name of a stale temporary, and in place of a live one.
  REQUIRE(write_file(folder.path / "victim", "precious"));
  const fs::path stale = stale_temporary(folder.path / "near.txt");
  fs::remove(stale);
  fs::create_symlink(folder.path / "victim", stale);
  REQUIRE(write_file(folder.path / "near.txt", "newer"));
  OutputFiles files;
  const auto temporary = files.add(folder.path / "near.txt");
  REQUIRE(temporary);
  fs::remove(*temporary);
  fs::create_symlink(folder.path / "victim", *temporary);
  CHECK_FALSE(files.commit());
  CHECK(content(folder.path / "victim") == "precious");
  CHECK(content(folder.path / "far" / "real.txt") == "newer");
}

TEST_CASE("two names of one file are an error in one set") {
  const tests::TemporaryFolder folder;
  fs::create_symlink("a", folder.path / "b");
  OutputFiles files;
  REQUIRE(files.write(folder.path / "a", "x"));
  const auto twice = files.write(folder.path / "b", "y");
  REQUIRE_FALSE(twice);
  CHECK(twice.error().message().find("b: is the same file as ") != std::string::npos);
}

TEST_CASE("a replaced file keeps its permissions and a new one gets those of the umask") {
  const tests::TemporaryFolder folder;
  const mode_t mask = umask(027);
  REQUIRE(write_file(folder.path / "new", "x"));
  CHECK(permissions(folder.path / "new") == 0640);
  for (const mode_t mode : {0600u, 0664u, 0777u}) {
    REQUIRE(chmod((folder.path / "new").c_str(), mode) == 0);
    REQUIRE(write_file(folder.path / "new", "y"));
    CHECK(permissions(folder.path / "new") == mode);
  }
  umask(mask);
  REQUIRE(chmod((folder.path / "new").c_str(), 0444) == 0);
  if (geteuid() == 0) return tests::skipped("root may write to a read-only file");
  CHECK_FALSE(write_file(folder.path / "new", "z"));
}

TEST_CASE("a pipe that appears at a target is neither replaced nor waited for") {
  const tests::TemporaryFolder folder;
  OutputFiles files;
  REQUIRE(files.write(folder.path / "a", "x"));
  REQUIRE(files.write(folder.path / "b", "x"));
  REQUIRE(mkfifo((folder.path / "b").c_str(), 0600) == 0);
  CHECK_FALSE(files.commit());
  CHECK(fs::is_fifo(folder.path / "b"));
  CHECK_FALSE(fs::exists(folder.path / "a"));
  OutputFiles more;
  CHECK_FALSE(more.add(folder.path / "b"));
  CHECK(more.add_scratch(folder.path / "b"));
}

TEST_CASE("a folder that a script has locked delays a set and does not stop it") {
  const tests::TemporaryFolder folder;
  const int script = open(folder.path.c_str(), O_RDONLY | O_DIRECTORY);
  REQUIRE(flock(script, LOCK_EX) == 0);
  OutputFiles files;
  REQUIRE(files.write(folder.path / "a", "x"));
  REQUIRE(files.write(folder.path / "b", "x"));
  CHECK(files.commit());
  CHECK(count_of(folder.path) == 2);
  close(script);
}

TEST_CASE("a full disk is named as such") {
  CHECK(write_error("a.wav", ENOSPC).message() ==
        "a.wav: disk full; free some space, or write to another disk");
  CHECK(write_error("a.wav", EACCES).message() ==
        "a.wav: cannot be written: Permission denied; choose a writable location");
}

TEST_CASE("a program that ends removes all its temporaries but those that it keeps, and writes no more") {
  const tests::TemporaryFolder folder;
  REQUIRE(write_file(folder.path / "a", "old"));
  const pid_t other = fork();
  REQUIRE(other >= 0);
  if (other == 0) {
    OutputFiles one, two, kept(OutputFiles::WhenStopped::keep);
    const bool is_ready = write_file(folder.path / "c", "whole") && one.write(folder.path / "a", "new") &&
                          one.add_scratch(folder.path / "a") && two.write(folder.path / "b", "new") &&
                          kept.write(folder.path / "d", "part");
    const AbandonedOutputs left = abandon_outputs();
    std::thread([&] { (void)one.commit(); }).detach();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // for the thread to do wrong
    _exit(is_ready && left.committed > 0 && left.kept == 1 ? 0 : 1);
  }
  int status = 0;
  REQUIRE(waitpid(other, &status, 0) == other);
  CHECK(status == 0);
  CHECK(content(folder.path / "a") == "old");
  CHECK(content(folder.path / "c") == "whole");
  CHECK(count_of(folder.path) == 3);  // with what is kept
  for (StaleTemporary& stale : claim_stale_temporaries(folder.path)) stale.remove();
  CHECK(count_of(folder.path) == 2);
}
