#include "window/panels.h"

#include <imgui/imgui.h>

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>

namespace intaglio::window {

namespace {

constexpr const char* representations[] = {"flat", "normal map", "relief"};

bool slider(const char* name, double& value, double low, double high, const char* format, int flags = 0) {
  return ImGui::SliderScalar(name, ImGuiDataType_Double, &value, &low, &high, format, flags);
}

void wrapped_text(const std::string& line) {
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(line.c_str());
  ImGui::PopTextWrapPos();
}

void time_panel(Settings& settings, const session::LiveState& state, PanelActions& actions) {
  if (ImGui::Button(settings.paused ? "Resume (Space)" : "Pause (Space)")) settings.paused = !settings.paused;
  ImGui::SameLine();
  actions.single = ImGui::Button("Step (N)");
  ImGui::SameLine();
  actions.reset = ImGui::Button("Reset (R)");
  slider("speed", settings.speed, 0.01, 1, "%.2f", ImGuiSliderFlags_Logarithmic);
  wrapped_text(fmt::format("{:.2f} s", state.time));
}

void surface_panel(Settings& settings, const session::LiveSession& session) {
  const scene::Scene& scene = session.scene();
  if (!ImGui::CollapsingHeader("Surface", ImGuiTreeNodeFlags_DefaultOpen)) return;
  int chosen = int(scene.surface.representation);
  for (int k = 0; k < 3; ++k) {
    if (k > 0) ImGui::SameLine();
    if (ImGui::RadioButton(representations[k], chosen == k)) settings.representation = k;
  }
  if (chosen == 2) {
    // How relief is drawn: 0 exact, 1 classic, then meshes.
    constexpr std::array<int, 2> squares{256, 512};
    int way = settings.mesh == squares[0] ? 2 : settings.mesh == squares[1] ? 3 : settings.classic ? 1 : 0;
    if (ImGui::Combo("relief drawn as", &way,
                     "traced\0traced, 32 + 6 steps\0mesh of 256 x 256\0mesh of 512 x 512\0")) {
      settings.classic = way == 1;
      settings.mesh = way < 2 ? 0 : squares[std::size_t(way - 2)];
    }
  }
  const surface::Surface& made = *session.surface().surface;
  double depth = 1e3 * (made.has_depth() ? made.max_depth() : 0);
  if (slider("depth, mm", depth, 0, 100 * scene.surface.size.maxCoeff(), "%.1f",
             ImGuiSliderFlags_Logarithmic))
    settings.depth = 1e-3 * depth;
  const std::string material = settings.material.empty() ? "scene default" : settings.material;
  if (ImGui::BeginCombo("material", material.c_str())) {
    if (ImGui::Selectable("scene default", settings.material.empty())) settings.material.clear();
    for (const Material& m : materials())
      if (ImGui::Selectable(m.name.c_str(), settings.material == m.name)) settings.material = m.name;
    ImGui::EndCombo();
  }
  int method = settings.use_paper_method ? 1 : 0;
  ImGui::RadioButton("closest feature", &method, 0);
  ImGui::SameLine();
  ImGui::RadioButton("paper's method", &method, 1);
  settings.use_paper_method = method == 1;
}

void senses_panel(Settings& settings) {
  if (!ImGui::CollapsingHeader("Texture affects", ImGuiTreeNodeFlags_DefaultOpen)) return;
  ImGui::Checkbox("sight", &settings.sees);
  ImGui::SameLine();
  ImGui::Checkbox("touch", &settings.feels);
  ImGui::SameLine();
  ImGui::Checkbox("sound", &settings.hears);
  ImGui::SameLine();
  ImGui::Checkbox("motion", &settings.moves);
  slider("volume, dB", settings.volume, -40, 40, "%.0f");
  ImGui::Checkbox("mute (M)", &settings.mute);
  ImGui::SameLine();
  ImGui::Checkbox("rumble", &settings.rumble);
}

// One row: a switch, a delay, a shift along u. A slider's value holds when it is let go, because another
// session is made for it.
void cue_row(Settings& settings, const session::LiveSession& session, scene::Cue cue, const char* name) {
  static std::array<scene::CueSettings, scene::all_cues.size()> edited;  // one window a process
  static int held = -1;                                                  // the row whose slider is held
  const int row = int(cue);
  auto& setting = settings.cues[std::size_t(cue)];
  scene::CueSettings& edit = edited[std::size_t(cue)];
  if (held != row) edit = setting.value_or(session.scene().cues[cue]);
  ImGui::PushID(row);
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  if (ImGui::Checkbox(name, &edit.on)) setting = edit;
  const auto number = [&](const char* id, double& value, double low, double high, const char* format) {
    ImGui::TableNextColumn();
    ImGui::SetNextItemWidth(-1);
    double shown = 1e3 * value;
    if (slider(id, shown, low, high, format)) value = 1e-3 * std::round(shown);
    if (ImGui::IsItemActive()) held = row;
    if (ImGui::IsItemDeactivated() && held == row) held = -1;
    if (ImGui::IsItemDeactivatedAfterEdit()) setting = edit;
  };
  number("##delay", edit.delay, 0, 300, "%.0f ms");
  number("##shift", edit.shift.x(), -50, 50, "%.0f mm");
  ImGui::PopID();
}

void cues_panel(Settings& settings, const session::LiveSession& session) {
  if (!ImGui::CollapsingHeader("Lies: on, late, shifted")) return;
  if (ImGui::BeginTable("cues", 3, ImGuiTableFlags_SizingFixedFit)) {
    const float em = ImGui::GetFontSize();
    for (const float width : {8.2f, 5.7f, 5.7f})
      ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, width * em);
    for (const scene::Cue cue : scene::all_cues) {
      constexpr std::array names = {"sight", "touch", "pen heard", "motion", "balls heard"};
      cue_row(settings, session, cue, names[std::size_t(cue)]);
    }
    ImGui::EndTable();
  }
  if (ImGui::Button("All true")) settings.cues.fill(scene::CueSettings());
  for (const std::string& change : scene::cue_changes(session.scene().cues)) wrapped_text(change);
}

// The address of a VRPN device, used when Enter is pressed; empty: the mouse.
void device_field(Settings& settings) {
  static std::array<char, 128> typed{};  // edit buffer; one window a process
  if (ImGui::InputTextWithHint("VRPN pen", settings.device.empty() ? "NAME@HOST" : settings.device.c_str(),
                               typed.data(), typed.size(), ImGuiInputTextFlags_EnterReturnsTrue)) {
    settings.device = typed.data();
    settings.device_source.clear();
  }
}

void touch_panel(Settings& settings, session::LiveSession& session, const PanelData& data,
                 const session::LiveState& state, PanelActions& actions) {
  if (!ImGui::CollapsingHeader("Touch", ImGuiTreeNodeFlags_DefaultOpen)) return;
  ImGui::Checkbox("mouse moves the pen (P)", &settings.pen);
  device_field(settings);
  double stiffness = session.scene().pen->spring.stiffness;
  if (slider("stiffness, N/m", stiffness, 50, 2000, "%.0f")) settings.stiffness = stiffness;
  if (!data.force.empty())
    ImGui::PlotLines("##force", data.force.data(), int(data.force.size()), 0,
                     fmt::format("force {:.2f} N", state.pen.felt.norm()).c_str(), 0, 8,
                     ImVec2(ImGui::GetContentRegionAvail().x, 4.6f * ImGui::GetFontSize()));
  if ((state.pen.guard_status & haptics::guard_status::fault) != 0) {
    wrapped_text("Force cut off by the safety guard");
    actions.rearm = ImGui::Button("Re-arm");
  }
}

void view_panel(Settings& settings, PanelActions& actions) {
  if (!ImGui::CollapsingHeader("View")) return;
  ImGui::Checkbox("contacts", &settings.overlay_contacts);
  ImGui::SameLine();
  ImGui::Checkbox("n_g, n_s", &settings.overlay_normals);
  ImGui::SameLine();
  ImGui::Checkbox("pen's force", &settings.overlay_pen);
  ImGui::Checkbox("timing", &settings.overlay_timing);
  ImGui::SameLine();
  ImGui::Checkbox("scope", &settings.overlay_scope);
  slider("minimum frames/s", settings.min_frame_rate, 5, 60, "%.0f");
  ImGui::SliderInt("supersampling", &settings.samples, 1, 3);
  actions.home = ImGui::Button("Camera home (H)");
  ImGui::SameLine();
  actions.screenshot = ImGui::Button("Screenshot (F12)");
}

std::string microseconds(double seconds) {
  return seconds < 1e-3 ? fmt::format("{:.1f} us", 1e6 * seconds) : fmt::format("{:.1f} ms", 1e3 * seconds);
}

void timing_panel(session::LiveSession& session, const PanelData& data, const session::LiveState& state) {
  if (!ImGui::CollapsingHeader("Timing", ImGuiTreeNodeFlags_DefaultOpen)) return;
  wrapped_text(
      fmt::format("picture   {:.1f} ms, {:.0f} % size", 1e3 * data.frame_seconds, 100 * data.picture_scale));
  wrapped_text(fmt::format("dynamics  {} per step, {} skipped", microseconds(state.step_seconds),
                           state.dropped_steps));
  const haptics::ServoLoop& servo = session.servo();
  wrapped_text(fmt::format("touch     {}, wake-up {} (p99)", microseconds(servo.compute().quantile(0.5)),
                           microseconds(servo.wake_up().quantile(0.99))));
  if (session.has_sound()) {
    wrapped_text(fmt::format("sound     {:.0f} % busy, {} underruns", 100 * data.audio.peak_load,
                             data.audio.underruns));
  } else {
    wrapped_text("sound     baking models");
  }
  wrapped_text(data.audio_device);
  if (!data.gamepad.empty()) wrapped_text(data.gamepad);
  wrapped_text(data.driver);
}

}  // namespace

PanelActions draw_panels(Settings& settings, session::LiveSession* session, const PanelData& data,
                         double scale) {
  PanelActions actions;
  const auto s = float(scale);
  ImGui::SetNextWindowPos(ImVec2(12 * s, 12 * s), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints(ImVec2(300 * s, 0), ImVec2(300 * s, FLT_MAX));
  if (ImGui::Begin("Intaglio", nullptr, ImGuiWindowFlags_AlwaysAutoResize) && session != nullptr) {
    const session::LiveState& state = session->state();
    wrapped_text(data.title);
    ImGui::PushItemWidth(160 * s);
    time_panel(settings, state, actions);
    actions.record = ImGui::Button(data.recorded < 0 ? "Record (F9)"
                                                     : fmt::format("Stop ({:.1f} s)", data.recorded).c_str());
    surface_panel(settings, *session);
    senses_panel(settings);
    cues_panel(settings, *session);
    touch_panel(settings, *session, data, state, actions);
    view_panel(settings, actions);
    if (settings.overlay_timing) timing_panel(*session, data, state);
    if (settings.overlay_scope && !data.scope.empty())
      ImGui::PlotLines("##scope", data.scope.data(), int(data.scope.size()), 0, "audio output", -1, 1,
                       ImVec2(ImGui::GetContentRegionAvail().x, 60 * s));
    ImGui::PopItemWidth();
  }
  ImGui::End();
  return actions;
}

void draw_status_line(const Settings& settings, const PanelData& data) {
  constexpr double shown = 8;  // s
  std::string line = data.messages.empty() || data.message_age > shown ? "" : data.messages.back();
  if (data.is_loading) line = "loading ...";
  if (data.recorded >= 0) line = fmt::format("recording {:.1f} s    {}", data.recorded, line);
  if (settings.paused) line = "paused    " + line;
  if (line.empty()) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const ImVec2 extent = ImGui::CalcTextSize(line.c_str(), nullptr, false, 0.96f * size.x);
  const float unit = ImGui::GetFontSize() / 13;
  const ImVec2 at(0.02f * size.x, size.y - extent.y - 12 * unit);
  ImDrawList* list = ImGui::GetForegroundDrawList();
  list->AddRectFilled(ImVec2(at.x - 8 * unit, at.y - 5 * unit),
                      ImVec2(at.x + extent.x + 8 * unit, at.y + extent.y + 5 * unit),
                      IM_COL32(10, 12, 16, 200), 5 * unit);
  list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), at, IM_COL32(235, 235, 235, 255), line.c_str(),
                nullptr, 0.96f * size.x);
}

namespace {

// Draws world-space lines over the picture.
class Pencil {
 public:
  Pencil(const Projection& projection, const Vec2& window)
      : projection_(projection), window_(window), list_(*ImGui::GetBackgroundDrawList()) {}

  std::optional<ImVec2> at(const Vec3& world) const {
    const auto place = projection_.project(world);
    if (!place || !place->allFinite() || place->cwiseAbs().maxCoeff() > 50) return std::nullopt;
    return ImVec2(float(place->x() * window_.x()), float(place->y() * window_.y()));
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
  const std::uint64_t first =
      state.mark_count > session::max_marks ? state.mark_count - session::max_marks : 0;
  for (std::uint64_t k = first; k < state.mark_count; ++k) {
    const session::ContactMark& mark = state.marks[k % session::max_marks];
    const double age = state.time - mark.time;
    if (age < 0 || age > seconds) continue;
    const int alpha = int(255 * (1 - age / seconds));
    if (settings.overlay_contacts) {
      pencil.dot(mark.point, mark.begins ? IM_COL32(255, 120, 60, alpha) : IM_COL32(90, 210, 255, alpha), 4);
      // Impulses span decades, so an arrow's length is logarithmic in them, from about 0.1 mN s.
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

void draw_pen_overlay(Pencil& pencil, session::LiveSession& session, const haptics::ServoReport& pen,
                      double side) {
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
  const double force = pen.felt.norm();
  if (force < 0.02) return;
  pencil.arrow(pen.proxy, pen.proxy + 0.06 * side * pen.felt, IM_COL32(255, 70, 70, 255));
  pencil.text(pen.proxy + 0.06 * side * pen.felt, fmt::format("{:.2f} N", force));
}

}  // namespace

void draw_overlays(const Settings& settings, session::LiveSession& session, const Projection& projection,
                   const OverlayData& data) {
  Pencil pencil(projection, data.window);
  const session::LiveState& state = session.state();
  if (settings.overlay_contacts || settings.overlay_normals) draw_marks(pencil, settings, state, data.side);
  if (settings.pen && settings.overlay_pen) draw_pen_overlay(pencil, session, state.pen, data.side);
  if (data.is_dragging) {
    pencil.line(data.grip, data.pull_to, IM_COL32(255, 255, 255, 200));
    pencil.ring(data.pull_to, IM_COL32(255, 255, 255, 220), 7);
  }
}

}  // namespace intaglio::window
