// What is on: the session that runs, the renderer that shows it, and how one follows another. Private to
// window/; one thread (the window's), with the window's context current.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "intaglio/haptics/devices/vrpn/vrpn_device.h"
#include "intaglio/session/scene_picture.h"
#include "intaglio/sound/outputs/open_device.h"
#include "intaglio/window/file_watch.h"
#include "intaglio/window/loader.h"
#include "intaglio/window/settings.h"

namespace intaglio::window {

class Stage {
 public:
  // Opens sound and the pen's device; a note where one of them is not what was hoped for.
  Result<std::string> open(const std::string& audio, const std::string& device);
  ~Stage();

  // Loads a scene from its own file or as it is; the one that is on stays until the new one is there.
  void ask(const session::Scene& scene, const Settings& settings, bool goes_on);
  // A dropped file: a scene, or a texture for the floor. An error when it is neither.
  Result<void> drop(const std::filesystem::path& file, const Settings& settings);
  // Asks again when the settings or the watched files need it. What there is to say.
  std::string keep_up(const Settings& settings, double now);
  // What there is to say at the end of a device that was asked for and has not answered.
  std::string unanswered(const Settings& settings) const;
  // Takes what has been loaded. Whether there is a new session; `message` says what went wrong or what is on.
  bool poll(std::string& message);

  session::LiveSession* session() { return session_.get(); }
  const session::Scene& scene() const { return base_; }  // as its file says
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
  session::VoiceBaker baker_;
  std::unique_ptr<sound::AudioDevice> audio_;
  std::shared_ptr<haptics::vrpn::VrpnDevice> pen_, dialled_;  // asked for, and not heard of yet
  std::shared_ptr<haptics::Device> sessions_pen_;             // of the session that is on
  std::string device_;                                        // what was asked for last
  double dialled_since_ = 0;
  Loader loader_;
  session::Scene base_, asked_base_;  // what is on, and what was asked for
  std::optional<Settings> asked_;     // with which settings
  std::filesystem::path scene_file_;
  FileWatch watch_, shader_watch_;
  std::filesystem::path shaders_;
  bool wants_shaders_ = false;  // of the folder: not read yet by this renderer
  std::unique_ptr<session::LiveSession> session_;
  std::unique_ptr<session::ScenePicture> picture_;
  std::unique_ptr<render::Renderer> renderer_;
  int picture_width_ = 0, picture_height_ = 0, samples_ = 0, mesh_ = 0;
  bool classic_ = false;
};

// The scene with what the panels changed.
session::Scene with_settings(session::Scene scene, const Settings& settings);

}  // namespace intaglio::window
