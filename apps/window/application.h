// `intaglio run`: a window onto a live scene.
//
//   events ─▶ Hands (camera, drag, pen, keys) ─▶ Controls ─▶ LiveSession ─▶ LiveState ─▶ picture, overlays,
//   panels
//                                 Settings ◀─ panels, scripts; a change that needs it ─▶ Loader ─▶ the next
//                                 session
//
// Everything here is the window's thread. A scene or texture that cannot be read leaves the one that is shown
// and says why. docs/run.md is the user's page.
#pragma once

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "window/script.h"

namespace intaglio::window {

struct RunOptions {
  scene::Scene scene;
  std::filesystem::path scene_file;  // watched; empty: not from a file
  std::vector<ScriptEvent> script;
  std::string device;                     // NAME@HOST of a VRPN pen; empty: the mouse
  std::string audio = "default";          // devices.h
  std::filesystem::path shaders;          // folder of shaders to draw with, watched; empty: those built in
  std::filesystem::path record_to;        // folder of recordings and screenshots; empty: the current one
  std::optional<int> width, height;       // else the last run's
  std::optional<double> interface_scale;  // else by the screen
  bool keeps_settings = true;             // reads and writes the user's
  const std::atomic<bool>* interrupted = nullptr;
};

// How a run went: deadlines of every sense.
struct RunReport {
  double seconds = 0;
  double start_seconds = 0;  // from run() to the first picture of the scene
  std::string driver, audio_device;
  struct Frames {
    std::uint64_t count = 0, late = 0;        // late: longer than a thirtieth of a second
    double median = 0, p99 = 0, longest = 0;  // s
  } frames;
  struct Touch {
    std::uint64_t ticks = 0, left_out = 0;
    double wake_p99 = 0, compute_p99 = 0;  // s
    std::string priority;
  } touch;
  struct Dynamics {
    std::uint64_t steps = 0, left_out = 0;
    double step_seconds = 0;
  } dynamics;
  struct Sound {
    std::uint64_t buffers = 0, underruns = 0, events = 0, dropped = 0;
    double busiest = 0, delay = 0;
  } sound;
  std::uint64_t bodies_taken = 0;  // by the mouse
  std::uint64_t gl_errors = 0;
  std::vector<std::string> gl_error_names;
  std::vector<std::string> messages;  // all that the window said, in order
  std::vector<std::string> written;   // screenshots and recordings
  bool was_baking = false;            // a thread is left behind (voices.h): end by std::_Exit
};

Result<RunReport> run(const RunOptions& options);

// How long pictures take: for the panel, the report, and how coarse the picture must be.

class FrameTimes {
 public:
  void add(double seconds) {
    all_.push_back(static_cast<float>(seconds));
    smooth_ = all_.size() == 1 ? seconds : smooth_ + 0.1 * (seconds - smooth_);
  }
  double smooth() const { return smooth_; }
  std::size_t count() const { return all_.size(); }
  std::size_t over(double seconds) const {
    return static_cast<std::size_t>(
        std::count_if(all_.begin(), all_.end(), [&](float t) { return static_cast<double>(t) > seconds; }));
  }
  double quantile(double q) const {
    if (all_.empty()) return 0;
    std::vector<float> sorted = all_;
    std::sort(sorted.begin(), sorted.end());
    return static_cast<double>(sorted[std::min(
        sorted.size() - 1, static_cast<std::size_t>(q * static_cast<double>(sorted.size())))]);
  }

 private:
  std::vector<float> all_;
  double smooth_ = 0;
};

}  // namespace intaglio::window
