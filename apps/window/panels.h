// The panels of the window: controls and read-outs. Dear ImGui, between PanelHost's begin() and draw(). They
// change Settings and return the actions that buttons ask for.
#pragma once

#include <deque>
#include <span>
#include <string>
#include <vector>

#include "session/live_session.h"
#include "sound/audio_device.h"
#include "window/settings.h"
#include "window/view_camera.h"

namespace intaglio::window {

// Panel contents besides the session itself.
struct PanelData {
  std::string title, driver, gamepad, audio_device;
  double frame_seconds = 0;  // smoothed
  double picture_scale = 1;  // picture side / window side
  bool is_loading = false;
  double recorded = -1;  // s; negative: not recording
  sound::AudioStatus audio;
  std::vector<float> force;          // N, the pen's, newest last
  std::vector<float> scope;          // audio output, -1..1, newest last
  std::deque<std::string> messages;  // newest last
  double message_age = 0;            // s, since the newest
};

struct PanelActions {
  bool reset = false, single = false, home = false, screenshot = false, record = false, rearm = false;
};

PanelActions draw_panels(Settings& settings, session::LiveSession* session, const PanelData& data,
                         double scale);

// Status line at the bottom, shown even when panels are hidden.
void draw_status_line(const Settings& settings, const PanelData& data);

// Overlays on the picture: contacts and their impulses, both normals, the pen's force, proxy and tangent
// plane, the drag. Dear ImGui's background list, between PanelHost's begin() and draw().
struct OverlayData {
  Vec2 window = Vec2(1, 1);  // size, in mouse units
  double side = 1;           // m, of the floor: scales arrows
  bool is_dragging = false;
  Vec3 grip = Vec3::Zero(), pull_to = Vec3::Zero();
};

void draw_overlays(const Settings& settings, session::LiveSession& session, const Projection& projection,
                   const OverlayData& data);

}  // namespace intaglio::window
