#include "intaglio/window/panel_host.h"

#include <SDL2/SDL.h>
#include <imgui/backends/imgui_impl_opengl3.h>
#include <imgui/imgui.h>

#include <algorithm>
#include <cmath>

namespace intaglio::window {

namespace {

struct KeyName {
  ImGuiKey_ imgui;
  SDL_Scancode sdl;
};
constexpr KeyName keys[] = {
    {ImGuiKey_Tab, SDL_SCANCODE_TAB},
    {ImGuiKey_LeftArrow, SDL_SCANCODE_LEFT},
    {ImGuiKey_RightArrow, SDL_SCANCODE_RIGHT},
    {ImGuiKey_UpArrow, SDL_SCANCODE_UP},
    {ImGuiKey_DownArrow, SDL_SCANCODE_DOWN},
    {ImGuiKey_Home, SDL_SCANCODE_HOME},
    {ImGuiKey_End, SDL_SCANCODE_END},
    {ImGuiKey_Delete, SDL_SCANCODE_DELETE},
    {ImGuiKey_Backspace, SDL_SCANCODE_BACKSPACE},
    {ImGuiKey_Enter, SDL_SCANCODE_RETURN},
    {ImGuiKey_Escape, SDL_SCANCODE_ESCAPE},
    {ImGuiKey_Space, SDL_SCANCODE_SPACE},
};

void dress(double scale, double density) {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 6;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.WindowBorderSize = 0;
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.07f, 0.08f, 0.10f, 0.86f);
  style.Colors[ImGuiCol_TitleBgActive] = ImVec4(0.12f, 0.14f, 0.18f, 0.95f);
  style.ScaleAllSizes(static_cast<float>(scale));
  ImFontConfig font;
  // As fine as the pixels, as large as the panels' units say.
  font.SizePixels = static_cast<float>(std::floor(13 * scale * density));
  ImGui::GetIO().FontGlobalScale = static_cast<float>(1 / density);
  ImGui::GetIO().Fonts->AddFontDefault(&font);
}

}  // namespace

PanelHost::PanelHost(double scale, double density) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // settings.h keeps what is kept
  io.BackendPlatformName = "intaglio";
  for (const KeyName& key : keys) io.KeyMap[key.imgui] = key.sdl;
  dress(scale, density);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

PanelHost::~PanelHost() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

bool PanelHost::take(const SDL_Event& event) {
  ImGuiIO& io = ImGui::GetIO();
  switch (event.type) {
    case SDL_MOUSEMOTION:
      io.MousePos = ImVec2(static_cast<float>(event.motion.x), static_cast<float>(event.motion.y));
      return io.WantCaptureMouse;
    case SDL_MOUSEWHEEL:
      io.MouseWheel += static_cast<float>(event.wheel.y);
      return io.WantCaptureMouse;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP: {
      const int button = event.button.button == SDL_BUTTON_LEFT    ? 0
                         : event.button.button == SDL_BUTTON_RIGHT ? 1
                                                                   : 2;
      io.MouseDown[button] = event.type == SDL_MOUSEBUTTONDOWN;
      if (event.type == SDL_MOUSEBUTTONDOWN) pressed_[button] = true;
      return io.WantCaptureMouse;
    }
    case SDL_TEXTINPUT:
      io.AddInputCharactersUTF8(event.text.text);
      return io.WantTextInput;
    case SDL_KEYDOWN:
    case SDL_KEYUP: {
      io.KeysDown[event.key.keysym.scancode] = event.type == SDL_KEYDOWN;
      const auto held = event.key.keysym.mod;
      io.KeyShift = (held & KMOD_SHIFT) != 0;
      io.KeyCtrl = (held & KMOD_CTRL) != 0;
      io.KeyAlt = (held & KMOD_ALT) != 0;
      return io.WantTextInput;
    }
    default:
      return false;
  }
}

void PanelHost::begin(const WindowSize& size, double seconds) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(size.window_width), static_cast<float>(size.window_height));
  io.DisplayFramebufferScale =
      ImVec2(static_cast<float>(size.width) / static_cast<float>(size.window_width),
             static_cast<float>(size.height) / static_cast<float>(size.window_height));
  io.DeltaTime = std::max(1e-4f, static_cast<float>(seconds));
  bool clicked[3];
  for (int k = 0; k < 3; ++k) {
    clicked[k] = std::exchange(pressed_[k], false) && !io.MouseDown[k];
    if (clicked[k]) io.MouseDown[k] = true;  // for this picture only
  }
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  for (int k = 0; k < 3; ++k)
    if (clicked[k]) io.MouseDown[k] = false;
}

void PanelHost::draw() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace intaglio::window
