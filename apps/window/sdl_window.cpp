#include "window/sdl_window.h"

#include <SDL2/SDL.h>
#include <epoxy/gl.h>
#include <imgui/backends/imgui_impl_opengl3.h>
#include <imgui/imgui.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "render/egl_context.h"

namespace intaglio::window {

namespace {

constexpr const char* no_window =
    "start it from a desktop session (or with ssh -X), or make a video instead: intaglio render SCENE -o out.mp4; "
    "without a display, use Xvfb or SDL_VIDEODRIVER=offscreen";

}  // namespace

Result<std::unique_ptr<SdlWindow>> SdlWindow::create(const std::string& title, int width, int height) {
  // SDL would silently pick the dummy driver.
  const auto is_set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && value[0] != 0;
  };
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY") && !is_set("SDL_VIDEODRIVER"))
    return fail("window", "there is no display (DISPLAY and WAYLAND_DISPLAY are not set)", no_window);
  std::unique_ptr<SdlWindow> made(new SdlWindow);
  SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0");
  SDL_SetMainReady();
  // Without a hint SDL tries Wayland, too, which complains on standard error.
  if (!is_set("WAYLAND_DISPLAY") && !is_set("SDL_VIDEODRIVER")) SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11");
  if (SDL_Init(SDL_INIT_VIDEO) != 0)
    return fail("window", fmt::format("cannot open a display ({})", SDL_GetError()), no_window);
  SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER);  // optional: without it there is no gamepad
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
  SDL_GL_SetAttribute(SDL_GL_DOUBLEBUFFER, 1);
  SDL_GL_SetAttribute(SDL_GL_DEPTH_SIZE, 0);
  made->window_ =
      SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, width, height,
                       SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI);
  const std::string driver = SDL_GetCurrentVideoDriver();
  if (made->window_ != nullptr && !is_set("SDL_VIDEODRIVER") && (driver == "offscreen" || driver == "dummy"))
    return fail("window", "the display cannot be reached", no_window);
  if (made->window_ == nullptr)
    return fail("window", fmt::format("cannot be opened ({})", SDL_GetError()), no_window);
  made->context_ = SDL_GL_CreateContext(made->window_);
  if (made->context_ == nullptr)
    return fail("window", fmt::format("has no OpenGL 3.3 ({})", SDL_GetError()),
                "install a driver: Mesa's llvmpipe (libgl1-mesa-dri) needs no graphics card");
  if (SDL_GL_SetSwapInterval(-1) != 0) SDL_GL_SetSwapInterval(1);
  return made;
}

SdlWindow::~SdlWindow() {
  if (context_ != nullptr) SDL_GL_DeleteContext(context_);
  if (window_ != nullptr) SDL_DestroyWindow(window_);
  SDL_Quit();
}

WindowSize SdlWindow::size() const {
  WindowSize size;
  SDL_GL_GetDrawableSize(window_, &size.width, &size.height);
  SDL_GetWindowSize(window_, &size.window_width, &size.window_height);
  size.width = std::max(size.width, 1);
  size.height = std::max(size.height, 1);
  size.window_width = std::max(size.window_width, 1);
  size.window_height = std::max(size.window_height, 1);
  float dpi = 96;
  if (SDL_GetDisplayDPI(std::max(SDL_GetWindowDisplayIndex(window_), 0), &dpi, nullptr, nullptr) != 0)
    dpi = 96;
  size.scale = panel_scale(double(dpi), size.density());
  return size;
}

double panel_scale(double dpi, double density) {
  const double by_screen = dpi > 400 || !(dpi >= 110) ? 1 : std::round(4 * dpi / 96) / 4;
  return std::max(1.0, by_screen / std::max(density, 1.0));
}

void SdlWindow::resize(int width, int height) {
  SDL_SetWindowSize(window_, width, height);
}

void SdlWindow::set_title(const std::string& title) {
  SDL_SetWindowTitle(window_, title.c_str());
}

void SdlWindow::swap() {
  SDL_GL_SwapWindow(window_);
}

Image8 SdlWindow::pixels() const {
  const WindowSize now = size();
  Image8 up(now.width, now.height, 3), image = up;
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, now.width, now.height, GL_RGB, GL_UNSIGNED_BYTE, up.data.data());
  const auto row = std::ptrdiff_t(3 * now.width);
  for (int y = 0; y < now.height; ++y)
    std::copy_n(up.data.begin() + (now.height - 1 - y) * row, row, image.data.begin() + y * row);
  return image;
}

std::string SdlWindow::description() const {
  return fmt::format("{}, {}", SDL_GetCurrentVideoDriver(), render::description_of_current());
}

std::string gl_error() {
  const GLenum error = glGetError();
  switch (error) {
    case GL_NO_ERROR:
      return "";
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    default:
      return fmt::format("OpenGL error {:#x}", error);
  }
}

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

void apply_style(double scale, double density) {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 6;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.WindowBorderSize = 0;
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.07f, 0.08f, 0.10f, 0.86f);
  style.Colors[ImGuiCol_TitleBgActive] = ImVec4(0.12f, 0.14f, 0.18f, 0.95f);
  style.ScaleAllSizes(float(scale));
  ImFontConfig font;
  // Rasterised at pixel density, displayed at logical size.
  font.SizePixels = float(std::floor(13 * scale * density));
  ImGui::GetIO().FontGlobalScale = float(1 / density);
  ImGui::GetIO().Fonts->AddFontDefault(&font);
}

}  // namespace

PanelHost::PanelHost(double scale, double density) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // settings are saved by settings.h
  io.BackendPlatformName = "intaglio";
  for (const KeyName& key : keys) io.KeyMap[key.imgui] = key.sdl;
  apply_style(scale, density);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

PanelHost::~PanelHost() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

bool PanelHost::handle_event(const SDL_Event& event) {
  ImGuiIO& io = ImGui::GetIO();
  switch (event.type) {
    case SDL_MOUSEMOTION:
      io.MousePos = ImVec2(float(event.motion.x), float(event.motion.y));
      return io.WantCaptureMouse;
    case SDL_MOUSEWHEEL:
      io.MouseWheel += float(event.wheel.y);
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
  io.DisplaySize = ImVec2(float(size.window_width), float(size.window_height));
  io.DisplayFramebufferScale =
      ImVec2(float(size.width) / float(size.window_width), float(size.height) / float(size.window_height));
  io.DeltaTime = std::max(1e-4f, float(seconds));
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
