#include "intaglio/window/overlays.h"

#include <imgui/imgui.h>

#include <algorithm>
#include <cmath>

namespace intaglio::window {

namespace {

// Draws world lines onto the picture.
class Pencil {
 public:
  Pencil(const Projection& projection, const Vec2& window)
      : projection_(projection), window_(window), list_(*ImGui::GetBackgroundDrawList()) {}

  std::optional<ImVec2> at(const Vec3& world) const {
    const auto place = projection_.project(world);
    if (!place || !place->allFinite() || place->cwiseAbs().maxCoeff() > 50) return std::nullopt;
    return ImVec2(static_cast<float>(place->x() * window_.x()), static_cast<float>(place->y() * window_.y()));
  }
  void line(const Vec3& from, const Vec3& to, ImU32 colour, float width = 2) {
    const auto a = at(from), b = at(to);
    if (a && b) list_.AddLine(*a, *b, colour, width);
  }
  void dot(const Vec3& where, ImU32 colour, float radius) {
    if (const auto p = at(where)) list_.AddCircleFilled(*p, radius, colour, 16);
  }
  void ring(const Vec3& where, ImU32 colour, float radius) {
    if (const auto p = at(where)) list_.AddCircle(*p, radius, colour, 24, 2);
  }
  void arrow(const Vec3& from, const Vec3& to, ImU32 colour) {
    const auto a = at(from), b = at(to);
    if (!a || !b) return;
    const ImVec2 d(b->x - a->x, b->y - a->y);
    const float length = std::hypot(d.x, d.y);
    if (length < 1) return;
    const ImVec2 u(d.x / length, d.y / length);
    const float head = std::min(10.0f, 0.5f * length);
    const ImVec2 base(b->x - head * u.x, b->y - head * u.y);
    list_.AddLine(*a, base, colour, 3);
    list_.AddTriangleFilled(*b, ImVec2(base.x - 0.5f * head * u.y, base.y + 0.5f * head * u.x),
                            ImVec2(base.x + 0.5f * head * u.y, base.y - 0.5f * head * u.x), colour);
  }
  void patch(const Vec3& middle, const Vec3& a, const Vec3& b, ImU32 fill, ImU32 edge) {
    const auto p = at(middle - a - b), q = at(middle + a - b), r = at(middle + a + b), s = at(middle - a + b);
    if (!p || !q || !r || !s) return;
    list_.AddQuadFilled(*p, *q, *r, *s, fill);
    list_.AddQuad(*p, *q, *r, *s, edge, 1);
  }
  void text(const Vec3& where, const std::string& words) {
    if (const auto p = at(where))
      list_.AddText(ImVec2(p->x + 12, p->y - 6), IM_COL32(255, 240, 200, 255), words.c_str());
  }

 private:
  const Projection& projection_;
  Vec2 window_;
  ImDrawList& list_;
};

void draw_marks(Pencil& pencil, const Settings& settings, const session::LiveState& state, double side) {
  constexpr double seconds = 0.25;  // until a mark has faded
  const std::uint64_t first = state.marks > session::most_marks ? state.marks - session::most_marks : 0;
  for (std::uint64_t k = first; k < state.marks; ++k) {
    const session::ContactMark& mark = state.mark[k % session::most_marks];
    const double age = state.time - mark.time;
    if (age < 0 || age > seconds) continue;
    const int alpha = static_cast<int>(255 * (1 - age / seconds));
    if (settings.overlay_contacts) {
      pencil.dot(mark.point, mark.begins ? IM_COL32(255, 120, 60, alpha) : IM_COL32(90, 210, 255, alpha), 4);
      // Impulses span decades: an arrow grows with the logarithm of newton-seconds over a micro one.
      const double size = mark.impulse.norm();
      const double length = 0.02 * side * std::log1p(1e4 * size);
      if (size > 0)
        pencil.arrow(mark.point, mark.point + length * mark.impulse / size, IM_COL32(255, 200, 60, alpha));
    }
    if (settings.overlay_normals) {
      pencil.line(mark.point, mark.point + 0.08 * side * mark.n_g, IM_COL32(120, 255, 120, alpha));
      pencil.line(mark.point, mark.point + 0.08 * side * mark.n_s, IM_COL32(255, 110, 230, alpha));
    }
  }
}

void draw_pen(Pencil& pencil, session::LiveSession& session, const haptics::ServoReport& pen, double side) {
  const surface::Surface& surface = *session.surface().surface;
  const surface::Placement& place = surface.placement();
  if (pen.touching) {
    const Vec3 n = surface.world_normal(place.uv(place.to_local(pen.proxy)));
    const Vec3 a = n.cross(place.b()).normalized(), b = n.cross(a);
    const double r = 0.03 * side;
    pencil.patch(pen.proxy, r * a, r * b, IM_COL32(90, 160, 255, 60), IM_COL32(130, 190, 255, 200));
    pencil.line(pen.proxy, pen.tip, IM_COL32(255, 255, 255, 160));
    pencil.dot(pen.tip, IM_COL32(255, 255, 255, 200), 3);
  }
  pencil.ring(pen.proxy, IM_COL32(255, 255, 255, 220), 6);
  const double force = pen.force.norm();
  if (force < 0.02) return;
  pencil.arrow(pen.proxy, pen.proxy + 0.06 * side * pen.force, IM_COL32(255, 70, 70, 255));
  pencil.text(pen.proxy + 0.06 * side * pen.force, fmt::format("{:.2f} N", force));
}

}  // namespace

void draw_overlays(const Settings& settings, session::LiveSession& session, const Projection& projection,
                   const OverlayFacts& facts) {
  Pencil pencil(projection, facts.window);
  const session::LiveState& state = session.state();
  if (settings.overlay_contacts || settings.overlay_normals) draw_marks(pencil, settings, state, facts.side);
  if (settings.pen && settings.overlay_pen) draw_pen(pencil, session, state.pen, facts.side);
  if (facts.is_dragging) {
    pencil.line(facts.grip, facts.pull_to, IM_COL32(255, 255, 255, 200));
    pencil.ring(facts.pull_to, IM_COL32(255, 255, 255, 220), 7);
  }
}

}  // namespace intaglio::window
