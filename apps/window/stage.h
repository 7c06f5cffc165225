// Whether files have changed since they were last looked at: by their times, asked for twice a second. A
// folder counts with all files in it. One thread.
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

class FileWatch {
 public:
  void watch(std::vector<std::filesystem::path> paths);
  // Whether anything has changed since watch() or the last change that was told, `now` in seconds.
  bool has_changed(double now);

 private:
  using Time = std::filesystem::file_time_type;
  std::vector<Time> times() const;

  std::vector<std::filesystem::path> paths_;
  std::vector<Time> seen_;
  double next_ = 0;
};

// Makes live sessions in a thread of its own, so that the window goes on while textures are read. Asked again
// while it works, it makes what was asked for last. One thread (the window's).

struct LoadRequest {
  scene::Scene scene;
  session::LiveSessionOptions options;
  std::shared_ptr<haptics::Device> device;       // the pen's; none: the mouse
  std::optional<scene::SceneSurface> surface;    // when it is known already
  bool goes_on = false;                          // bodies go on where they are
};

struct Loaded {
  std::unique_ptr<session::LiveSession> session;  // null: see error
  std::optional<Error> error;
  LoadRequest request;
};

class Loader {
 public:
  Loader();
  ~Loader();

  void ask(LoadRequest request);
  std::optional<Loaded> take();
  bool is_busy();

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<LoadRequest> wanted_;
  std::optional<Loaded> done_;
  bool busy_ = false, closed_ = false;
  std::thread thread_;
};

// What is on: the session that runs, the renderer that shows it, and how one follows another. Private to
// window/; one thread (the window's), with the window's context current.

class Stage {
 public:
  // Opens sound and the pen's device; a note where one of them is not what was hoped for.
  Result<std::string> open(const std::string& audio, const std::string& device);
  ~Stage();

  // Loads a scene from its own file or as it is; the one that is on stays until the new one is there.
  void ask(const scene::Scene& scene, const Settings& settings, bool goes_on);
  // A dropped file: a scene, or a texture for the floor. An error when it is neither.
  Result<void> drop(const std::filesystem::path& file, const Settings& settings);
  // Asks again when the settings or the watched files need it. What there is to say.
  std::string keep_up(const Settings& settings, double now);
  // What there is to say at the end of a device that was asked for and has not answered.
  std::string unanswered(const Settings& settings) const;
  // Takes what has been loaded. Whether there is a new session; `message` says what went wrong or what is on.
  bool poll(std::string& message);

  session::LiveSession* session() { return session_.get(); }
  const scene::Scene& scene() const { return base_; }  // as its file says
  void set_scene_file(const std::filesystem::path& file) { scene_file_ = file; }
  // Draws with the shaders of this folder, and reads them again when they change.
  void set_shaders(const std::filesystem::path& folder);
  bool is_loading() { return loader_.is_busy(); }

  // Draws into the window's framebuffer.
  Result<void> draw(const render::Camera& camera, const Settings& settings, int width, int height,
                    double scale);
  render::Renderer* renderer() { return renderer_.get(); }

  session::AudioTap& tap() { return tap_; }
  sound::AudioDevice* audio() { return audio_.get(); }
  // A model is being made, which nothing can stop.
  bool is_baking() const { return baker_.is_busy(); }

 private:
  Result<void> show();
  std::string keep_pen(const Settings& settings, double now);

  session::AudioTap tap_;
  scene::VoiceBaker baker_;
  std::unique_ptr<sound::AudioDevice> audio_;
  std::shared_ptr<haptics::vrpn::VrpnDevice> pen_, dialled_;  // asked for, and not heard of yet
  std::shared_ptr<haptics::Device> sessions_pen_;             // of the session that is on
  std::string device_;                                        // what was asked for last
  double dialled_since_ = 0;
  Loader loader_;
  scene::Scene base_, asked_base_;    // what is on, and what was asked for
  std::optional<Settings> asked_;     // with which settings
  std::filesystem::path scene_file_;
  FileWatch watch_, shader_watch_;
  std::filesystem::path shaders_;
  bool wants_shaders_ = false;  // of the folder: not read yet by this renderer
  std::unique_ptr<session::LiveSession> session_;
  std::unique_ptr<scene::ScenePicture> picture_;
  std::unique_ptr<render::Renderer> renderer_;
  int picture_width_ = 0, picture_height_ = 0, samples_ = 0, mesh_ = 0;
  bool classic_ = false;
};

// The scene with what the panels changed.
scene::Scene with_settings(scene::Scene scene, const Settings& settings);

}  // namespace intaglio::window
