// The running session, its renderer, and switching sessions. Private to window/; one thread (the window's),
// with the window's context current.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "haptics/vrpn/vrpn_device.h"
#include "scene/picture.h"
#include "session/live_session.h"
#include "sound/audio/devices.h"
#include "window/settings.h"

namespace intaglio::window {

// Watches files: polls modification times twice a second; a folder includes its direct files.
class FileWatch {
 public:
  void watch(std::vector<std::filesystem::path> paths);
  // Whether anything has changed since watch() or the last reported change; `now` in seconds.
  bool has_changed(double now);

 private:
  using Time = std::filesystem::file_time_type;
  std::vector<Time> times() const;

  std::vector<std::filesystem::path> paths_;
  std::vector<Time> seen_;
  double next_ = 0;
};

struct LoadRequest {
  scene::Scene scene;
  session::LiveSessionOptions options;
  std::shared_ptr<haptics::Device> device;     // the pen's; none: the mouse
  std::optional<scene::SceneSurface> surface;  // if already loaded
  bool keeps_bodies = false;                   // bodies keep their state
};

struct Loaded {
  std::unique_ptr<session::LiveSession> session;  // null: see error
  std::optional<Error> error;
  LoadRequest request;
};

// Makes live sessions in a thread of its own, so that the window does not wait for textures. A newer request
// replaces a pending one.
class Loader {
 public:
  Loader();
  ~Loader();

  void request(LoadRequest request);
  std::optional<Loaded> take();
  bool is_busy();

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<LoadRequest> pending_;
  std::optional<Loaded> result_;
  bool busy_ = false, closed_ = false;
  std::thread thread_;
};

// The pen's device: a VRPN device or the mouse. Another device is connected while the old one stays in use.
class PenDevice {
 public:
  // Connects to NAME@HOST (empty: the mouse) and waits for an answer.
  Result<void> open(const std::string& name);
  // Starts connecting when the settings name another device; `message` says what came of it. Whether the
  // device has changed, so that a new session is needed.
  bool update(const Settings& settings, double now, std::string& message);
  // Why a requested device is not in use; empty if none is pending.
  std::string connection_error(const Settings& settings) const;
  std::shared_ptr<haptics::Device> device() const { return used_; }

 private:
  using VrpnPen = std::shared_ptr<haptics::vrpn::VrpnDevice>;

  std::string name_;           // requested
  VrpnPen used_, connecting_;  // null: the mouse; none
  double connecting_since_ = 0;
};

// Counters of a session's threads.
struct SessionCounts {
  std::uint64_t ticks = 0, skipped_ticks = 0, steps = 0, skipped_steps = 0, events = 0, dropped_events = 0;

  // Adds those of a session.
  void add(session::LiveSession& session);
};

class Stage {
 public:
  // Opens sound and the pen's device; returns a note if a fallback is used.
  Result<std::string> open(const std::string& audio, const std::string& device);
  ~Stage();

  // Loads a scene asynchronously; the current one runs until it is ready.
  void request_scene(const scene::Scene& scene, const Settings& settings, bool keeps_bodies);
  // A dropped file: a scene, or a texture for the floor; an error if it is neither.
  Result<void> drop(const std::filesystem::path& file, const Settings& settings);
  // Reloads when settings or files have changed. Returns a message, or empty.
  std::string update(const Settings& settings, double now);
  std::string connection_error(const Settings& settings) const { return pen_.connection_error(settings); }
  // Switches to a session that has been loaded, if there is one. Whether its scene is a new one; `message` is
  // a note or the load error.
  bool take_loaded(std::string& message);

  session::LiveSession* session() { return session_.get(); }
  // The sum over all sessions so far.
  SessionCounts counts();
  const scene::Scene& scene() const { return scene_; }  // as its file has it, without the panels' changes
  void set_scene_file(const std::filesystem::path& file) { scene_file_ = file; }
  // Uses the shaders of this folder, and reloads them when they change.
  void set_shaders(const std::filesystem::path& folder);
  bool is_loading() { return loader_.is_busy(); }

  // Draws into the window's framebuffer.
  Result<void> draw(const render::Camera& camera, const Settings& settings, int width, int height,
                    double scale);
  render::Renderer* renderer() { return renderer_.get(); }

  session::AudioTap& tap() { return tap_; }
  sound::AudioDevice* audio() { return audio_.get(); }
  // A model is being baked, or waits to be; the destructor abandons it.
  bool is_baking() const { return baker_.is_busy(); }

 private:
  Result<void> show();

  // Options of the current renderer.
  struct PictureOptions {
    int width = 0, height = 0, samples = 0, mesh_cells = 0;
    bool classic = false;
  };

  session::AudioTap tap_;
  scene::VoiceBaker baker_;
  std::unique_ptr<sound::AudioDevice> audio_;
  PenDevice pen_;
  Loader loader_;
  scene::Scene scene_, requested_scene_;
  std::optional<Settings> requested_settings_;
  std::filesystem::path scene_file_;
  FileWatch watch_, shader_watch_;
  std::filesystem::path shaders_;
  bool reload_shaders_ = false;                   // the renderer does not have those of the folder yet
  std::shared_ptr<haptics::Device> session_pen_;  // of session_, which it must outlive
  std::unique_ptr<session::LiveSession> session_;
  SessionCounts ended_;  // totals of earlier sessions
  std::unique_ptr<scene::ScenePicture> picture_;
  std::unique_ptr<render::Renderer> renderer_;
  PictureOptions drawn_;
};

// The scene with the panels' changes.
scene::Scene with_settings(scene::Scene scene, const Settings& settings);

}  // namespace intaglio::window
