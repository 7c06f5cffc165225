// What is drawn over the picture: contacts and their impulses, both normals, the pen's force, proxy and
// tangent plane, what is dragged. Dear ImGui's background list, between PanelHost's begin() and draw().
#pragma once

#include "intaglio/session/live/live_session.h"
#include "intaglio/window/settings.h"
#include "intaglio/window/view_camera.h"

namespace intaglio::window {

struct OverlayFacts {
  Vec2 window = Vec2(1, 1);  // size, in mouse units
  double side = 1;           // m, of the floor: arrows are as long as fits
  bool is_dragging = false;
  Vec3 grip = Vec3::Zero(), pull_to = Vec3::Zero();
};

void draw_overlays(const Settings& settings, session::LiveSession& session, const Projection& projection,
                   const OverlayFacts& facts);

}  // namespace intaglio::window
