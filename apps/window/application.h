// `intaglio run`: a window onto a live scene.
//
//   SDL events -> InputController -> Controls -> LiveSession -> LiveState -> picture, overlays, panels
//   panels, scripts -> Settings -> (when a new session is needed) -> Loader -> the next LiveSession
//
// Runs on the window's thread. On a load error the current scene stays and the error is shown. docs/run.md is
// the user's page.
#pragma once

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <functional>
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
  std::filesystem::path shaders;          // folder of shaders, watched; empty: the built-in ones
  std::filesystem::path record_to;        // folder of recordings and screenshots; empty: the current one
  std::optional<int> width, height;       // default: last run's
  std::optional<double> interface_scale;  // default: from the display
  bool keeps_settings = true;             // reads and writes the user's settings file
  const std::atomic<bool>* interrupted = nullptr;
  std::function<void()> left;  // called when the user has left the window, before a recording is saved
};

// Statistics of a run: how each sense kept its deadlines.
struct RunReport {
  double seconds = 0;
  double start_seconds = 0;  // from run() to the first picture of the scene
  std::string driver, audio_device;
  struct Frames {
    std::uint64_t count = 0, late = 0;        // late: longer than 1/30 s
    double median = 0, p99 = 0, longest = 0;  // s
  } frames;
  struct Touch {
    std::uint64_t ticks = 0, skipped = 0;
    double wake_p99 = 0, compute_p99 = 0;  // s
    std::string priority;
  } touch;
  struct Dynamics {
    std::uint64_t steps = 0, skipped = 0;
    double step_seconds = 0;
  } dynamics;
  struct Sound {
    std::uint64_t buffers = 0, underruns = 0, events = 0, dropped = 0;
    double peak_load = 0, delay = 0;
  } sound;
  std::uint64_t bodies_dragged = 0;
  std::uint64_t gl_errors = 0;
  std::vector<std::string> gl_error_names;
  std::vector<std::string> messages;       // all messages shown, in order
  std::vector<std::string> files_written;  // screenshots and recordings
  bool was_baking = false;                 // a model was being baked at the end, and was abandoned
};

// Calls `ended` when the recording is saved and the settings are written: what follows joins threads, whose
// bakes, imports and look-ups may take seconds. It may end the process.
Result<void> run(const RunOptions& options, const std::function<void(const RunReport&)>& ended);

// Frame times: for the panel, the report and adaptive resolution.
class FrameTimes {
 public:
  void add(double seconds) {
    all_.push_back(float(seconds));
    smooth_ = all_.size() == 1 ? seconds : smooth_ + 0.1 * (seconds - smooth_);
  }
  double smooth() const { return smooth_; }
  std::size_t count() const { return all_.size(); }
  std::size_t over(double seconds) const {
    return std::size_t(std::count_if(all_.begin(), all_.end(), [&](float t) { return double(t) > seconds; }));
  }
  double quantile(double q) const {
    if (all_.empty()) return 0;
    std::vector<float> sorted = all_;
    std::sort(sorted.begin(), sorted.end());
    return double(sorted[std::min(sorted.size() - 1, std::size_t(q * double(sorted.size())))]);
  }

 private:
  std::vector<float> all_;
  double smooth_ = 0;
};

}  // namespace intaglio::window
