#include "report/report.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>

#include "core/file.h"
#include "core/portable_math.h"
#include "report/agreement.h"
#include "report/digest.h"
#include "report/html.h"
#include "report/svg_plot.h"
#include "surface/import.h"
#include "surface/recipes/builtin.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::scene;
using namespace intaglio::report;
using namespace intaglio::session;

namespace {

std::shared_ptr<const surface::Surface> brick_surface() {
  surface::BrickRecipe recipe;
  recipe.size = 64;
  const surface::Placement placement(Vec3::Zero(), Quat::Identity(), 1, 1);
  return std::make_shared<const surface::Surface>(surface::to_texels(surface::make_brick(recipe)), placement,
                                                  0.02, surface::Edge::wrap);
}

// One ball that lands every half second and rings a mode of 3000 Hz; a pen that follows the surface.
Recording session_of(double seconds) {
  Recording r;
  r.title = "A test";
  r.duration = seconds;
  r.surface = brick_surface();
  r.pen = 2;
  r.voices = {{0, "floor", "brick", {500, 3000}, {0.05, 0.1}}, {1, "ball 1", "glass", {7000}, {0.05}}};
  r.audio.assign(std::size_t(seconds * r.sample_rate), 0.0f);
  r.balls.push_back({1, 0.05});
  r.tracks.emplace_back();
  for (int k = 1; k <= seconds * r.physics_rate; ++k) {
    r.tracks[0].push_back(Vec3(0.1, 0.05 + std::abs(std::sin(k * 0.01)), 0.1));
  }
  for (double time = 0.25; time < seconds; time += 0.5) {
    ContactEvent event;
    event.time = time;
    event.body = 1;
    event.impulse = Vec3(0, 0.1, 0);
    r.events.push_back(event);
    const auto start = std::size_t(time * r.sample_rate);
    for (std::size_t k = 0; start + k < r.audio.size() && k < 8000; ++k) {
      const double t = double(k) / r.sample_rate;
      r.audio[start + k] += float(0.5 * std::exp(-t * 69) * std::sin(2 * M_PI * 3000 * t));
    }
  }
  for (int k = 0; k < seconds * r.servo_rate; ++k) {
    haptics::ServoSample sample;
    sample.uv = Vec2(0.1 + 0.2 * k / (seconds * r.servo_rate), 0.4);
    sample.surface_height = -r.surface->depth(sample.uv);
    sample.tip =
        r.surface->placement().to_world({sample.uv.x(), sample.uv.y(), sample.surface_height - 1e-3});
    sample.touching = k > 200;
    sample.force = Vec3(0, sample.touching ? 0.6 : 0.0, 0);
    r.servo.push_back(sample);
  }
  r.key_frames.push_back({0.5, Image8(640, 360, 3)});
  r.costs = {{"sound", "64-sample block", 64.0 / 44100, 100, 10, 20, 0.001}};
  return r;
}

// Every number that a fault could break, broken.
Recording broken_session() {
  const double nan = std::nan(""), inf = HUGE_VAL;
  Recording r = session_of(1);
  r.duration = nan;
  r.tracks[0][10] = Vec3(nan, inf, 1e300);
  r.balls.push_back({3, nan});
  for (std::size_t k = 0; k < 6; ++k) r.events.push_back(r.events[0]);
  r.events[1].time = nan;
  r.events[2].impulse = Vec3(inf, 0, 0);
  r.events[3].point = Vec3(nan, nan, nan);
  r.events[4].duration = inf;
  r.events[5].time = -1e300;
  r.servo[300].tip = Vec3(nan, inf, 0);
  r.servo[301].force = Vec3(inf, 0, 0);
  r.servo[302].surface_height = -inf;
  r.audio[5] = std::nanf("");
  r.audio[6] = 1e30f;
  r.voices.push_back({7, "", "", {nan, -1, 0, inf}, {inf, nan}});
  r.costs.push_back({"odd", "none", nan, 0, inf, nan, 0});
  r.bake_s = inf;
  r.wall_s = -inf;
  r.momentum_residual = nan;
  r.key_frames.push_back({nan, {}});
  return r;
}

std::string page_of(const Digest& digest, const PageVideo& video = {}) {
  std::string page;
  REQUIRE(write_report(digest, video, [&](std::string_view text) { page += text; }));
  return page;
}
std::string page_of(const Recording& recording, const PageVideo& video = {}) {
  return page_of(*digest_of(recording), video);
}

// The page without its images, whose letters are chance.
std::string without_data(const std::string& html) {
  std::string out;
  std::size_t from = 0;
  for (std::size_t at; (at = html.find("base64,", from)) != std::string::npos;) {
    out.append(html, from, at - from);
    from = html.find('"', at);
  }
  return out + html.substr(from);
}

// The first thing that is wrong with the nesting of tags, or nothing. (No regular expression: libstdc++'s
// recurse for each letter.)
std::string nesting_fault(const std::string& html) {
  static const std::set<std::string> empty = {"meta", "img", "!DOCTYPE"};
  std::vector<std::string> open;
  std::size_t at = 0;
  while ((at = html.find('<', at)) != std::string::npos) {
    const std::size_t end = html.find('>', at);
    if (end == std::string::npos) return "a tag without end";
    const std::string tag = html.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(0, tag.find_first_of(" \n"));
    at = end + 1;
    if (std::count(tag.begin(), tag.end(), '"') % 2 != 0) return "an attribute without end in " + name;
    if (tag.front() == '/') {
      if (open.empty() || "/" + open.back() != name)
        return "<" + name + "> closes " + (open.empty() ? "nothing" : open.back());
      open.pop_back();
    } else if (tag.back() != '/' && empty.count(name) == 0) {
      open.push_back(name);
      // Its content is not markup.
      if (name == "style" || name == "script") at = html.find("</" + name, at);
    }
  }
  return open.empty() ? "" : open.back() + " stays open";
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++count;
  return count;
}

}  // namespace

TEST_CASE("a report is well-formed, complete and finite for any recording") {
  const tests::TemporaryFolder folder;
  const PageVideo video{folder.path / "a.mp4", "a.mp4"};
  REQUIRE(write_file(video.file, std::string_view("\0\1\2\3", 4)));
  for (const Recording& recording : {Recording{}, session_of(2), broken_session()}) {
    const std::string html = without_data(page_of(recording, video));
    CHECK(nesting_fault(html) == "");
    for (const char* id : {"seen", "felt", "moved", "heard", "agreement", "cost"}) {
      CHECK(count_of(html, std::string("<section id=\"") + id + "\"") == 1);
    }
    std::smatch found;
    const bool odd = std::regex_search(
        html, found, std::regex("(^|[^a-zA-Z])-?(nan|inf)([^a-zA-Z]|$)", std::regex::icase));
    CHECK_MESSAGE(
        !odd, (odd ? html.substr(std::size_t(std::max<std::ptrdiff_t>(0, found.position() - 80)), 160) : ""));
    CHECK(count_of(html, "<img ") == count_of(html, "alt=\""));
    CHECK(count_of(html, "<svg ") == count_of(html, "aria-label=\"") - count_of(html, "<video "));
    CHECK(count_of(html, "<table>") == count_of(html, "<caption>"));
    CHECK(html.find("src=\"http") == std::string::npos);
  }
}

TEST_CASE("text from outside is escaped") {
  Recording recording = session_of(1);
  recording.title = "<script>alert('x')</script> & \"more\"";
  recording.voices[0].name = "<b>floor";
  recording.voices[0].material = "a&b";
  recording.costs[0].sense = "<i>";
  const std::string html = page_of(recording);
  CHECK(count_of(html, "<script>") == 1);  // the page's own
  CHECK(html.find("&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt; &amp; &quot;more&quot;") !=
        std::string::npos);
  CHECK(html.find("<b>floor") == std::string::npos);
  CHECK(html.find("a&b<") == std::string::npos);
  CHECK(html.find("<i>") == std::string::npos);
}

TEST_CASE("one instant is one vertical line through all tracks") {
  const Recording recording = session_of(2);
  const auto digest = digest_of(recording);
  const std::vector<Impact> impacts = strongest(digest->contacts().impacts(), 40, 0.03);
  CHECK(impacts.size() == 4);
  const std::regex line("<line class=\"impact [^\"]*\" x1=\"([0-9.]+)\"");
  const std::regex frame("class=\"frame\" x=\"76.00\" y=\"[0-9.]+\" width=\"900.00\"");
  for (const std::string& svg : {felt_html(*digest), moved_html(*digest), heard_html(*digest)}) {
    CHECK(svg.find("viewBox=\"0 0 1100 ") != std::string::npos);
    CHECK(std::distance(std::sregex_iterator(svg.begin(), svg.end(), frame), std::sregex_iterator()) == 2);
    std::size_t k = 0;
    for (auto m = std::sregex_iterator(svg.begin(), svg.end(), line); m != std::sregex_iterator(); ++m, ++k) {
      REQUIRE(k < impacts.size());
      CHECK(std::stod((*m)[1]) == doctest::Approx(76 + 900 * impacts[k].time / 2).epsilon(1e-4));
    }
    CHECK(k == impacts.size());
  }
}

TEST_CASE("agreement is near perfect for a session that agrees, and chance for one that does not") {
  Recording recording = session_of(4);
  const Agreement good = measure_agreement(*digest_of(recording));
  CHECK(good.onsets == 8);
  CHECK(good.onsets_at_touch == 1);
  CHECK(good.touches == 8);
  CHECK(good.touches_heard == 1);
  CHECK(std::abs(good.median_lag) <= 0.002);
  CHECK(good.relief_correlation > 0.999);
  CHECK(good.idle_energy < 1e-5);
  CHECK(good.modal_energy > 0.9);
  CHECK(good.modal_contrast_db > 10);

  for (ContactEvent& event : recording.events) event.time += 0.2;
  recording.voices[0].frequencies = {730, 5000};
  const Agreement bad = measure_agreement(*digest_of(recording));
  CHECK(bad.onsets_at_touch == 0);
  CHECK(bad.touches_heard == 0);
  CHECK(bad.idle_energy > 0.5);
  CHECK(bad.modal_energy < 0.1);
}

TEST_CASE(
    "a touch is the increase of a contact's impulse, at its time; faint and masked touches need no sound") {
  Recording recording;
  recording.duration = 2;
  const auto add = [&](int k, double impulse, ContactPhase phase, double touch_age = std::nan("")) {
    ContactEvent event;
    event.time = 0.002 * k;
    event.duration = 0.002;
    event.body = 1;
    event.phase = phase;
    event.impulse = {0, impulse, 0};
    event.touch_age = touch_age;
    recording.events.push_back(event);
  };
  add(10, 0.1, ContactPhase::begin, 0.0015);  // lands
  for (int k = 11; k < 300; ++k)              // slides, and meets edges at 200 and 210
    add(k, k == 200 ? 0.08 : k == 210 ? 0.05 : k == 250 ? 0.001 : 0.0008, ContactPhase::persist);
  const std::vector<AudibleTouch> touches = digest_of(recording)->contacts().touches().touches(1);
  REQUIRE(touches.size() == 3);
  CHECK(touches[0].time == doctest::Approx(0.0185));
  CHECK(touches[1].time == doctest::Approx(0.399));
  CHECK(touches[1].impulse == doctest::Approx(0.0792));
  CHECK(touches[2].time == doctest::Approx(0.419));
  const std::vector<AudibleTouch> clear = unmasked(touches);
  REQUIRE(clear.size() == 2);
  CHECK(clear[1].time == touches[1].time);
}

TEST_CASE("measures that do not apply are NaN and print as a dash") {
  const Agreement none = measure_agreement(*digest_of(Recording{}));
  for (const double value : {none.onsets_at_touch, none.touches_heard, none.relief_correlation,
                             none.idle_energy, none.modal_energy, none.modal_contrast_db}) {
    CHECK(std::isnan(value));
  }
  CHECK(format_number(std::nan(""), 2) == "–");
  CHECK(format_number(-HUGE_VAL) == "–");
  CHECK(format_number(-0.001, 1) == "0.0");
  CHECK(format_number(-1.25, 1) == "−1.2");
}

TEST_CASE("a curve keeps its peaks however many samples fall into one unit") {
  DrawnCurve curve(Axis({0, 100000}, {0, 100}), 0, 1);
  for (int k = 0; k < 100000; ++k) curve.add(k == 54321);
  SvgPlot plot(100, 100, "plot", "t", "d");
  plot.curve(Axis({0, 1}, {100, 0}), curve, "curve");
  const std::string svg = plot.finish();
  CHECK(svg.find("54.3 0.0") != std::string::npos);
  CHECK(svg.size() < 4000);
}

TEST_CASE("the page stays small even for noise") {
  Recording recording = session_of(5);
  Random random(1);
  for (float& sample : recording.audio) sample = float(0.3 * random.normal());
  KeyFrame frame{0, Image8(1280, 720, 3)};
  for (std::uint8_t& value : frame.image.data) value = std::uint8_t(random.next());
  recording.key_frames.assign(12, frame);
  CHECK(page_of(recording).size() < 6'000'000);
}

TEST_CASE("base64 follows RFC 4648") {
  const auto encoded = [](std::string_view text) {
    return data_uri("t/t", std::vector<std::uint8_t>(text.begin(), text.end()));
  };
  CHECK(encoded("") == "data:t/t;base64,");
  CHECK(encoded("f") == "data:t/t;base64,Zg==");
  CHECK(encoded("fo") == "data:t/t;base64,Zm8=");
  CHECK(encoded("foobar") == "data:t/t;base64,Zm9vYmFy");
}
