#include <doctest/doctest.h>

#include <cmath>

#include "core/file.h"
#include "tests/temporary_folder.h"
#include "window/hands.h"
#include "window/settings.h"
#include "window/stage.h"

using namespace intaglio;
using namespace intaglio::window;

TEST_CASE("settings that are kept come back as they were; those of one run do not") {
  const tests::TemporaryFolder folder;
  const auto file = folder.path / "settings.toml";
  Settings settings;
  CHECK(set_by_name(settings, "volume", -6));
  CHECK(set_by_name(settings, "contacts", 0));
  CHECK(set_by_name(settings, "width", 801));
  CHECK(set_by_name(settings, "speed", 0.1));
  CHECK_FALSE(set_by_name(settings, "volum", 1));
  CHECK_FALSE(set_by_name(settings, "volume", 1e3));
  CHECK_FALSE(set_by_name(settings, "volume", std::nan("")));
  CHECK_FALSE(set_by_name(settings, "mute", 0.5));
  REQUIRE(write_settings(file, settings));
  Settings read;
  REQUIRE(read_settings(file, read));
  CHECK(read.volume == -6);
  CHECK(read.overlay_contacts == false);
  CHECK(read.width == 801);
  CHECK(read.speed == 1);
}

TEST_CASE("settings that cannot be read change nothing and say why; missing ones are the defaults") {
  const tests::TemporaryFolder folder;
  const auto file = folder.path / "broken.toml";
  Settings settings;
  CHECK(read_settings(folder.path / "none", settings));
  REQUIRE(write_file(file, std::string_view("volume = 3\nno such = 4\n")));
  CHECK_FALSE(read_settings(file, settings));
  REQUIRE(write_file(file, std::string_view("volume = 3\nwidht = 4\n")));
  const auto read = read_settings(file, settings);
  REQUIRE_FALSE(read);
  CHECK(read.error().message().find("width") != std::string::npos);
  CHECK(settings.volume == 0);
  REQUIRE(write_file(file, std::string_view("volume = 3\nsamples = 9\n")));
  const auto samples = read_settings(file, settings);
  REQUIRE_FALSE(samples);
  CHECK(samples.error().message().find(":2: samples is 9; it must be a whole number from 1 to 4") !=
        std::string::npos);
}

TEST_CASE("what is written can be read again, whatever the window was like") {
  const tests::TemporaryFolder folder;
  const auto file = folder.path / "clamped.toml";
  Settings settings;
  settings.width = 3;
  settings.volume = 1e9;
  REQUIRE(write_settings(file, settings));
  Settings read;
  REQUIRE(read_settings(file, read));
  CHECK(read.width == 16);
}

TEST_CASE("a changed file is noticed once, at most twice a second") {
  const tests::TemporaryFolder folder;
  const auto file = folder.path / "watched";
  REQUIRE(write_file(file, std::string_view("a")));
  FileWatch watch;
  watch.watch({file});
  CHECK_FALSE(watch.has_changed(0));
  std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) + std::chrono::seconds(2));
  CHECK_FALSE(watch.has_changed(0.4));
  CHECK(watch.has_changed(0.6));
  CHECK_FALSE(watch.has_changed(1.2));
}

TEST_CASE("rumble: a harder blow shakes more, old contacts do not, and never beyond 1") {
  session::LiveState state;
  CHECK(rumble_of(state, 0).blow == 0);
  double before = 0;
  for (const double impulse : {1e-3, 1e-2, 0.1, 100.0}) {
    state.marks[state.mark_count % session::max_marks].begins = true;
    state.marks[state.mark_count++ % session::max_marks].impulse = {0, impulse, 0};
    const Rumble rumble = rumble_of(state, state.mark_count - 1);
    CHECK(rumble.blow >= before);
    CHECK(rumble.blow <= 1);
    CHECK(rumble.slide == 0);
    before = rumble.blow;
  }
  CHECK(before == 1);
  CHECK(rumble_of(state, state.mark_count).blow == 0);
}
