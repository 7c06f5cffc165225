// The panels of the window: what can be chosen, and what is measured. Dear ImGui, between PanelHost's begin()
// and draw(). They change Settings and say what was asked for.
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

// What the panels show besides the session itself.
struct PanelFacts {
  std::string title, driver, gamepad, audio_device;
  double frame_seconds = 0;  // smoothed
  double picture_scale = 1;  // of the picture's sides to the window's
  bool is_loading = false;
  double recorded = -1;  // s; negative: not recording
  sound::AudioStatus audio;
  std::vector<float> force;          // N, the pen's, newest last
  std::vector<float> scope;          // what is heard, -1..1, newest last
  std::deque<std::string> messages;  // newest last
  double message_age = 0;            // s, since the newest
};

struct PanelActions {
  bool reset = false, single = false, home = false, screenshot = false, record = false, rearm = false;
};

PanelActions draw_panels(Settings& settings, session::LiveSession* session, const PanelFacts& facts,
                         double scale);

// The last message and what goes on, along the lower edge; also with the panels away.
void draw_status_line(const Settings& settings, const PanelFacts& facts);

// What is drawn over the picture: contacts and their impulses, both normals, the pen's force, proxy and
// tangent plane, what is dragged. Dear ImGui's background list, between PanelHost's begin() and draw().

struct OverlayFacts {
  Vec2 window = Vec2(1, 1);  // size, in mouse units
  double side = 1;           // m, of the floor: arrows are as long as fits
  bool is_dragging = false;
  Vec3 grip = Vec3::Zero(), pull_to = Vec3::Zero();
};

void draw_overlays(const Settings& settings, session::LiveSession& session, const Projection& projection,
                   const OverlayFacts& facts);

}  // namespace intaglio::window
