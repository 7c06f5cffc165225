#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "core/file.h"
#include "tests/temporary_folder.h"
#include "window/input.h"
#include "window/sdl_window.h"
#include "window/settings.h"
#include "window/stage.h"

using namespace intaglio;
using namespace intaglio::window;

TEST_CASE("saved settings are read back; those of one run are not") {
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

TEST_CASE(
    "an unreadable settings file changes nothing and is reported; missing settings keep their defaults") {
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
  CHECK(samples.error().message().find(":2: samples is 9; it must be an integer from 1 to 4") !=
        std::string::npos);
}

TEST_CASE("a written file can be read, whatever the settings were") {
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

TEST_CASE("a changed file is reported once, at most twice a second") {
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

TEST_CASE("rumble grows with impulse up to 1; old contacts do not count") {
  session::LiveState state;
  CHECK(contact_rumble(state, 0).impact == 0);
  double before = 0;
  for (const double impulse : {1e-3, 1e-2, 0.1, 100.0}) {
    state.marks[state.mark_count % session::max_marks].begins = true;
    state.marks[state.mark_count++ % session::max_marks].impulse = {0, impulse, 0};
    const Rumble rumble = contact_rumble(state, state.mark_count - 1);
    CHECK(rumble.impact >= before);
    CHECK(rumble.impact <= 1);
    CHECK(rumble.slide == 0);
    before = rumble.impact;
  }
  CHECK(before == 1);
  CHECK(contact_rumble(state, state.mark_count).impact == 0);
}

TEST_CASE("panels scale with the display's dots per inch, but not again when the desktop scales") {
  CHECK(panel_scale(96, 1) == 1);
  CHECK(panel_scale(192, 1) == 2);
  CHECK(panel_scale(144, 1) == 1.5);
  CHECK(panel_scale(192, 2) == 1);
  CHECK(panel_scale(288, 2) == 1.5);
  CHECK(panel_scale(96, 2) == 1);
  for (const double nonsense : {0.0, 20.0, 5000.0, std::numeric_limits<double>::quiet_NaN()})
    CHECK(panel_scale(nonsense, 1) == 1);
}
