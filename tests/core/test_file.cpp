#include <doctest/doctest.h>

#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "core/file.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
namespace fs = std::filesystem;

TEST_CASE("what is written is read back, and nothing else is left behind") {
  const tests::TemporaryFolder folder;
  const std::string text("a\0b\n", 4);
  REQUIRE(write_file(folder.path / "deep" / "x.bin", text));
  const auto bytes = read_file(folder.path / "deep" / "x.bin", 1u << 20);
  REQUIRE(bytes);
  CHECK(std::string(bytes->begin(), bytes->end()) == text);
  CHECK(std::distance(fs::directory_iterator(folder.path / "deep"), fs::directory_iterator()) == 1);
}

TEST_CASE("a missing file names the nearest one") {
  const tests::TemporaryFolder folder;
  REQUIRE(write_file(folder.path / "brick.png", "x"));
  const auto bytes = read_file(folder.path / "brik.png", 1u << 20);
  REQUIRE_FALSE(bytes);
  CHECK(bytes.error().message().find("brick.png") != std::string::npos);
}

TEST_CASE("an unwritable place is an error before and at writing") {
  const tests::TemporaryFolder folder;
  REQUIRE(write_file(folder.path / "file", "x"));
  CHECK_FALSE(check_writable(folder.path / "file" / "under_a_file.mp4"));
  CHECK_FALSE(write_file(folder.path / "file" / "under_a_file.mp4", "y"));
  CHECK_FALSE(check_writable(folder.path));
}

TEST_CASE("a file name must match the format") {
  CHECK(check_extension("out/a.wav", ".wav", "a WAV file"));
  CHECK(check_extension("out/a.b.WAV", ".wav", "a WAV file"));
  for (const char* name : {"a.mp3", "a", ".wav", "wav", "a.wav.mp3", ""}) {
    const auto named = check_extension(name, ".wav", "a WAV file");
    REQUIRE_FALSE(named);
    CHECK(named.error().message().find("is not named as a WAV file; end the name with .wav") !=
          std::string::npos);
  }
}

TEST_CASE("a device or pipe is not replaced by a file of its name") {
  const tests::TemporaryFolder folder;
  const auto pipe = folder.path / "pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  CHECK_FALSE(check_writable(pipe));
  const auto written = write_file(pipe, "x");
  REQUIRE_FALSE(written);
  CHECK(written.error().message().find("pipe: is a device or pipe, not a file; name a file") !=
        std::string::npos);
  CHECK(std::filesystem::is_fifo(pipe));
  CHECK_FALSE(write_file("", "x"));
  CHECK_FALSE(check_writable(folder.path / ""));
}

TEST_CASE("a file over the limit is rejected") {
  const tests::TemporaryFolder folder;
  REQUIRE(write_file(folder.path / "big", std::string(100, 'x')));
  CHECK_FALSE(read_file(folder.path / "big", 99));
  CHECK(read_file(folder.path / "big", 100));
}
