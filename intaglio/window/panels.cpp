#include "intaglio/window/panels.h"

#include <imgui/imgui.h>

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

void text(const std::string& line) {
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(line.c_str());
  ImGui::PopTextWrapPos();
}

void time_panel(Settings& settings, const session::LiveState& state, PanelActions& actions) {
  if (ImGui::Button(settings.paused ? "Go on (Space)" : "Pause (Space)")) settings.paused = !settings.paused;
  ImGui::SameLine();
  actions.single = ImGui::Button("Step (N)");
  ImGui::SameLine();
  actions.reset = ImGui::Button("Reset (R)");
  slider("speed", settings.speed, 0.01, 1, "%.2f", ImGuiSliderFlags_Logarithmic);
  text(fmt::format("{:.2f} s", state.time));
}

void surface_panel(Settings& settings, const session::LiveSession& session) {
  const session::Scene& scene = session.scene();
  if (!ImGui::CollapsingHeader("Surface", ImGuiTreeNodeFlags_DefaultOpen)) return;
  int chosen = static_cast<int>(scene.surface.representation);
  for (int k = 0; k < 3; ++k) {
    if (k > 0) ImGui::SameLine();
    if (ImGui::RadioButton(representations[k], chosen == k)) settings.representation = k;
  }
  if (chosen == 2) {
    // How relief is drawn: 0 exact, 1 classic, then meshes.
    constexpr std::array<int, 2> squares{256, 512};
    int way = settings.mesh == squares[0] ? 2 : settings.mesh == squares[1] ? 3 : settings.classic ? 1 : 0;
    if (ImGui::Combo("drawn", &way, "traced\0traced, 32 + 6 steps\0mesh of 256 x 256\0mesh of 512 x 512\0")) {
      settings.classic = way == 1;
      settings.mesh = way < 2 ? 0 : squares[std::size_t(way - 2)];
    }
  }
  const surface::Surface& made = *session.surface().surface;
  double depth = 1e3 * (made.has_depth() ? made.max_depth() : 0);
  if (slider("depth, mm", depth, 0, 100 * scene.surface.size.maxCoeff(), "%.1f",
             ImGuiSliderFlags_Logarithmic))
    settings.depth = 1e-3 * depth;
  const std::string material = settings.material.empty() ? "the scene's" : settings.material;
  if (ImGui::BeginCombo("material", material.c_str())) {
    if (ImGui::Selectable("the scene's", settings.material.empty())) settings.material.clear();
    for (const Material& m : materials())
      if (ImGui::Selectable(m.name.c_str(), settings.material == m.name)) settings.material = m.name;
    ImGui::EndCombo();
  }
  int method = settings.papers_method ? 1 : 0;
  ImGui::RadioButton("our method", &method, 0);
  ImGui::SameLine();
  ImGui::RadioButton("the paper's", &method, 1);
  settings.papers_method = method == 1;
}

void senses_panel(Settings& settings) {
  if (!ImGui::CollapsingHeader("Senses with the texture", ImGuiTreeNodeFlags_DefaultOpen)) return;
  ImGui::Checkbox("seen", &settings.sees);
  ImGui::SameLine();
  ImGui::Checkbox("felt", &settings.feels);
  ImGui::SameLine();
  ImGui::Checkbox("heard", &settings.hears);
  ImGui::SameLine();
  ImGui::Checkbox("moved on", &settings.moves);
  slider("volume, dB", settings.volume, -40, 40, "%.0f");
  ImGui::Checkbox("mute (M)", &settings.mute);
  ImGui::SameLine();
  ImGui::Checkbox("rumble", &settings.rumble);
}

// A VRPN device by its address, taken when Enter is pressed; nothing: the mouse.
void device_field(Settings& settings) {
  static std::array<char, 128> typed{};  // what is being typed is nobody else's business
  if (ImGui::InputTextWithHint("VRPN pen", settings.device.empty() ? "NAME@HOST" : settings.device.c_str(),
                               typed.data(), typed.size(), ImGuiInputTextFlags_EnterReturnsTrue)) {
    settings.device = typed.data();
    settings.device_from.clear();
  }
}

void touch_panel(Settings& settings, session::LiveSession& session, const PanelFacts& facts,
                 const session::LiveState& state, PanelActions& actions) {
  if (!ImGui::CollapsingHeader("Touch", ImGuiTreeNodeFlags_DefaultOpen)) return;
  ImGui::Checkbox("the mouse leads the pen (P)", &settings.pen);
  device_field(settings);
  double stiffness = session.scene().pen->spring.stiffness;
  if (slider("stiffness, N/m", stiffness, 50, 2000, "%.0f")) settings.stiffness = stiffness;
  if (!facts.force.empty())
    ImGui::PlotLines("##force", facts.force.data(), static_cast<int>(facts.force.size()), 0,
                     fmt::format("force {:.2f} N", state.pen.force.norm()).c_str(), 0, 8,
                     ImVec2(ImGui::GetContentRegionAvail().x, 4.6f * ImGui::GetFontSize()));
  if ((state.pen.guard_status & haptics::guard_status::fault) != 0) {
    text("the guard let go of the hand");
    actions.rearm = ImGui::Button("Take it again");
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
  slider("least frames/s", settings.least_rate, 5, 60, "%.0f");
  ImGui::SliderInt("samples a side", &settings.samples, 1, 3);
  actions.home = ImGui::Button("Camera home (H)");
  ImGui::SameLine();
  actions.screenshot = ImGui::Button("Screenshot (F12)");
}

std::string microseconds(double seconds) {
  return seconds < 1e-3 ? fmt::format("{:.1f} us", 1e6 * seconds) : fmt::format("{:.1f} ms", 1e3 * seconds);
}

void timing_panel(session::LiveSession& session, const PanelFacts& facts, const session::LiveState& state) {
  if (!ImGui::CollapsingHeader("Timing", ImGuiTreeNodeFlags_DefaultOpen)) return;
  text(fmt::format("picture   {:.1f} ms, {:.0f} % size", 1e3 * facts.frame_seconds,
                   100 * facts.picture_scale));
  text(fmt::format("dynamics  {} a step, {} left out", microseconds(state.step_seconds), state.late));
  const haptics::ServoLoop& servo = session.servo();
  text(fmt::format("touch     {}, wakes {} late (p99)", microseconds(servo.compute().quantile(0.5)),
                   microseconds(servo.wake_up().quantile(0.99))));
  if (session.has_sound()) {
    text(fmt::format("sound     {:.0f} % busy, {} underruns", 100 * facts.audio.busiest,
                     facts.audio.underruns));
  } else {
    text("sound     models are being made");
  }
  text(facts.audio_device);
  if (!facts.gamepad.empty()) text(facts.gamepad);
  text(facts.driver);
}

}  // namespace

PanelActions draw_panels(Settings& settings, session::LiveSession* session, const PanelFacts& facts,
                         double scale) {
  PanelActions actions;
  const auto s = static_cast<float>(scale);
  ImGui::SetNextWindowPos(ImVec2(12 * s, 12 * s), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints(ImVec2(300 * s, 0), ImVec2(300 * s, FLT_MAX));
  if (ImGui::Begin("Intaglio", nullptr, ImGuiWindowFlags_AlwaysAutoResize) && session != nullptr) {
    const session::LiveState& state = session->state();
    text(facts.title);
    ImGui::PushItemWidth(160 * s);
    time_panel(settings, state, actions);
    actions.record = ImGui::Button(
        facts.recorded < 0 ? "Record (F9)" : fmt::format("Stop ({:.1f} s)", facts.recorded).c_str());
    surface_panel(settings, *session);
    senses_panel(settings);
    touch_panel(settings, *session, facts, state, actions);
    view_panel(settings, actions);
    if (settings.overlay_timing) timing_panel(*session, facts, state);
    if (settings.overlay_scope && !facts.scope.empty())
      ImGui::PlotLines("##scope", facts.scope.data(), static_cast<int>(facts.scope.size()), 0, "heard", -1, 1,
                       ImVec2(ImGui::GetContentRegionAvail().x, 60 * s));
    ImGui::PopItemWidth();
  }
  ImGui::End();
  return actions;
}

void draw_status_line(const Settings& settings, const PanelFacts& facts) {
  constexpr double shown = 8;  // s
  std::string line = facts.messages.empty() || facts.message_age > shown ? "" : facts.messages.back();
  if (facts.is_loading) line = "loading ...";
  if (facts.recorded >= 0) line = fmt::format("recording {:.1f} s    {}", facts.recorded, line);
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

}  // namespace intaglio::window
