#include <doctest/doctest.h>
#include <fcntl.h>
#include <sndfile.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <thread>

#include "core/file.h"
#include "sound/audio/devices.h"
#include "sound/audio/wav.h"
#include "sound/synthesizer.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::sound;
namespace fs = std::filesystem;

namespace {

std::vector<float> wave() {
  std::vector<float> samples(5000);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = 0.9f * std::sin(0.01f * float(i * (i % 7)));
  return samples;
}

std::vector<float> read(const fs::path& path, SF_INFO& info) {
  SNDFILE* const file = sf_open(path.c_str(), SFM_READ, &info);
  REQUIRE(file != nullptr);
  std::vector<float> samples(std::size_t(info.frames * info.channels));
  CHECK(sf_readf_float(file, samples.data(), info.frames) == info.frames);
  sf_close(file);
  return samples;
}

}  // namespace

TEST_CASE("two channels are interleaved") {
  const tests::TemporaryFolder folder;
  const std::vector<float> stereo{0.5f, -0.5f, 0.25f, -0.25f};
  REQUIRE(write_wav(folder.path / "stereo.wav", stereo, 44'100, {WavFormat::float_32, 2}));
  SF_INFO info{};
  CHECK(read(folder.path / "stereo.wav", info) == stereo);
  CHECK(info.channels == 2);
  CHECK(info.frames == 2);
}

TEST_CASE("samples that are not whole frames of all channels are refused, and nothing is written") {
  const tests::TemporaryFolder folder;
  const std::vector<float> three{0.5f, -0.5f, 0.25f};
  for (const int channels : {2, 0, -1, -3}) {
    CAPTURE(channels);
    const auto refused = write_wav(folder.path / "a.wav", three, 44'100, {WavFormat::float_32, channels});
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message().find("3 samples cannot be " + std::to_string(channels) + " channels") !=
          std::string::npos);
    CHECK_FALSE(fs::exists(folder.path / "a.wav"));
  }
  CHECK(write_wav(folder.path / "a.wav", three, 44'100, {WavFormat::float_32, 3}));
}

TEST_CASE("a WAV file reads back as it was written, to the precision of its format") {
  const tests::TemporaryFolder folder;
  const fs::path path = folder.path / "new folder" / "a.wav";
  const std::vector<float> samples = wave();
  for (const auto& [format, precision] :
       {std::pair{WavFormat::pcm_16, 1.0 / 32768}, std::pair{WavFormat::pcm_24, 1.0 / 8388608},
        std::pair{WavFormat::float_32, 0.0}}) {
    REQUIRE(write_wav(path, samples, 48'000, {format}));
    SF_INFO info{};
    const std::vector<float> back = read(path, info);
    CHECK(info.samplerate == 48'000);
    CHECK(info.channels == 1);
    REQUIRE(back.size() == samples.size());
    float worst = 0;
    for (std::size_t i = 0; i < back.size(); ++i) worst = std::max(worst, std::abs(back[i] - samples[i]));
    CHECK(worst <= precision * 1.01);
  }
  CHECK(std::distance(fs::directory_iterator(path.parent_path()), fs::directory_iterator{}) == 1);
}

TEST_CASE("equal sounds are equal files, and PCM clips instead of wrapping") {
  const tests::TemporaryFolder folder;
  REQUIRE(write_wav(folder.path / "a.wav", wave(), 44'100, {WavFormat::float_32}));
  REQUIRE(write_wav(folder.path / "b.wav", wave(), 44'100, {WavFormat::float_32}));
  CHECK(*read_file(folder.path / "a.wav", 1u << 20) == *read_file(folder.path / "b.wav", 1u << 20));
  const std::vector<float> loud{2, -2, 0};
  REQUIRE(write_wav(folder.path / "loud.wav", loud, 44'100));
  SF_INFO info{};
  const std::vector<float> back = read(folder.path / "loud.wav", info);
  CHECK(back[0] == doctest::Approx(1));
  CHECK(back[1] == doctest::Approx(-1));
}

TEST_CASE("a sound that is written in pieces is the file that is written at once") {
  const tests::TemporaryFolder folder;
  const std::vector<float> samples = wave();
  for (const WavFormat format : {WavFormat::pcm_16, WavFormat::pcm_24, WavFormat::float_32}) {
    REQUIRE(write_wav(folder.path / "whole.wav", samples, 44'100, {format}));
    OutputFiles files;
    const auto temporary = files.add(folder.path / "pieces.wav");
    REQUIRE(temporary);
    auto writer = WavWriter::create(*temporary, folder.path / "pieces.wav", 44'100, {format});
    REQUIRE(writer);
    std::span<const float> left = samples;
    for (std::size_t size = 1; !left.empty(); size = 2 * size + 1) {
      const std::size_t now = std::min(size, left.size());
      writer->add(left.first(now));
      left = left.subspan(now);
    }
    REQUIRE(writer->finish());
    REQUIRE(files.commit());
    CHECK(*read_file(folder.path / "pieces.wav", 1u << 30) ==
          *read_file(folder.path / "whole.wav", 1u << 30));
  }
}

TEST_CASE("a failed write is an error that names the file and leaves nothing behind") {
  const tests::TemporaryFolder folder;
  const std::vector<float> samples = wave();
  REQUIRE(write_file(folder.path / "file", std::string_view("in the way")));
  const auto under_a_file = write_wav(folder.path / "file" / "a.wav", samples, 44'100);
  REQUIRE_FALSE(under_a_file);
  CHECK(under_a_file.error().where.find("a.wav") != std::string::npos);
  fs::create_directories(folder.path / "folder.wav");
  CHECK_FALSE(write_wav(folder.path / "folder.wav", samples, 44'100));
  CHECK_FALSE(write_wav(folder.path / "rate.wav", samples, 0));
  CHECK_FALSE(write_wav("/proc/no/such.wav", samples, 44'100));
  CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator{}) == 2);
}

TEST_CASE("the limiter is transparent below its knee, odd, increasing, smooth, and never beyond 1") {
  float before = soft_limit(-50), slope_jump = 0, last_slope = 0;
  for (int i = -5000; i <= 5000; ++i) {
    const float x = float(i) * 0.001f, y = soft_limit(x);
    if (std::abs(x) <= limiter_knee) CHECK(y == x);
    CHECK(std::abs(y) <= 1);
    CHECK(y == -soft_limit(-x));
    CHECK(y >= before);
    const float slope = (y - before) * 1000;
    if (i > -4990) slope_jump = std::max(slope_jump, std::abs(slope - last_slope));
    last_slope = slope;
    before = y;
  }
  CHECK(slope_jump < 0.02);
  CHECK(soft_limit(std::numeric_limits<float>::infinity()) == 1);
  CHECK(soft_limit(std::numeric_limits<float>::quiet_NaN()) == 0);
}

TEST_CASE("pascals become full scale by one constant and a gain") {
  const std::vector<float> pascals{10, -2, 0, 1e9f};
  std::vector<float> out(4);
  to_full_scale(pascals, out);
  CHECK(out[0] == doctest::Approx(10 / full_scale_pascal));
  CHECK(out[3] <= 1);
  to_full_scale(pascals, out, {-20});
  CHECK(out[1] == doctest::Approx(-0.2 / full_scale_pascal));
}

namespace {

std::pair<dev_t, ino_t> standard_error() {
  struct stat state {};
  CHECK(fstat(STDERR_FILENO, &state) == 0);
  return {state.st_dev, state.st_ino};
}

// While one lives, standard error is this file.
struct ErrorFile {
  int saved = dup(STDERR_FILENO);
  explicit ErrorFile(const fs::path& file) {
    const int to = open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    dup2(to, STDERR_FILENO);
    close(to);
  }
  ~ErrorFile() {
    dup2(saved, STDERR_FILENO);
    close(saved);
  }
};

}  // namespace

TEST_CASE("standard error is restored after it was silenced, also by two threads at once") {
  const tests::TemporaryFolder folder;
  const ErrorFile file(folder.path / "errors");
  const auto before = standard_error();
  {
    const QuietStandardError quiet;
    CHECK(standard_error() != before);
  }
  CHECK(standard_error() == before);
  const auto silence = [] {
    for (int k = 0; k < 1000; ++k) const QuietStandardError quiet;
  };
  std::thread one(silence), two(silence);
  one.join();
  two.join();
  CHECK(standard_error() == before);
}

TEST_CASE("a standard error that is closed stays closed") {
  const int error = dup(STDERR_FILENO), input = dup(STDIN_FILENO);
  REQUIRE(error >= 0);
  close(STDERR_FILENO);
  close(STDIN_FILENO);  // a lower descriptor that is free, for a redirection to take
  { const QuietStandardError quiet; }
  const bool is_closed = fcntl(STDERR_FILENO, F_GETFD) == -1;
  dup2(error, STDERR_FILENO);
  close(error);
  if (input >= 0) {
    dup2(input, STDIN_FILENO);
    close(input);
  }
  CHECK(is_closed);
}
