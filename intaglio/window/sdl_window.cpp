#include "intaglio/window/sdl_window.h"

#include <SDL2/SDL.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace intaglio::window {

namespace {

constexpr const char* no_window =
    "start it from a desktop session (or with ssh -X), or make a video instead: intaglio render SCENE -o out.mp4; "
    "without a screen, Xvfb or SDL_VIDEODRIVER=offscreen also do";

}  // namespace

Result<std::unique_ptr<SdlWindow>> SdlWindow::create(const std::string& title, int width, int height) {
  // SDL would quietly draw to nobody.
  const auto is_set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && value[0] != 0;
  };
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY") && !is_set("SDL_VIDEODRIVER"))
    return fail("window", "there is no display (DISPLAY and WAYLAND_DISPLAY are not set)", no_window);
  std::unique_ptr<SdlWindow> made(new SdlWindow);
  SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0");
  SDL_SetMainReady();
  // Asked for nothing else, SDL tries Wayland too, which then complains on standard error.
  if (!is_set("WAYLAND_DISPLAY") && !is_set("SDL_VIDEODRIVER")) SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11");
  if (SDL_Init(SDL_INIT_VIDEO) != 0)
    return fail("window", fmt::format("there is no display ({})", SDL_GetError()), no_window);
  SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER);  // without it there is no gamepad, nothing else
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
  size.scale = panel_scale(static_cast<double>(dpi), size.density());
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
  const auto row = static_cast<std::ptrdiff_t>(3 * now.width);
  for (int y = 0; y < now.height; ++y)
    std::copy_n(up.data.begin() + (now.height - 1 - y) * row, row, image.data.begin() + y * row);
  return image;
}

std::string SdlWindow::description() const {
  return fmt::format("{}, {}, OpenGL {}", SDL_GetCurrentVideoDriver(),
                     reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                     reinterpret_cast<const char*>(glGetString(GL_VERSION)));
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

}  // namespace intaglio::window
