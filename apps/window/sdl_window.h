// A window with an OpenGL 3.3 core context, by SDL2. The context stays current in the thread that made it,
// which is the only one to use it.
#pragma once

#include <memory>
#include <string>

#include "intaglio/error.h"
#include "intaglio/image.h"

struct SDL_Window;

namespace intaglio::window {

struct WindowSize {
  int width = 0, height = 0;                // of what is drawn, pixels
  int window_width = 0, window_height = 0;  // in the units of mouse events
  // How much larger than usual panels should be, in the units of mouse events; 1 or more.
  double scale = 1;

  // Pixels in a unit of mouse events: 1, or more where the desktop itself enlarges (Wayland, macOS).
  double density() const { return static_cast<double>(width) / window_width; }
};

// The scale of panels on a screen of that many dots an inch, by quarters; a screen that says nonsense counts
// as a usual one. What the desktop enlarges already is not enlarged again.
double panel_scale(double dpi, double density);

class SdlWindow {
 public:
  static Result<std::unique_ptr<SdlWindow>> create(const std::string& title, int width, int height);
  ~SdlWindow();
  SdlWindow(const SdlWindow&) = delete;
  SdlWindow& operator=(const SdlWindow&) = delete;

  WindowSize size() const;
  void resize(int width, int height);
  void set_title(const std::string& title);
  void swap();
  // What was drawn into the window since the last swap: RGB, row 0 at the top.
  Image8 pixels() const;
  // "x11, llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5": for reports.
  std::string description() const;

 private:
  SdlWindow() = default;

  SDL_Window* window_ = nullptr;
  void* context_ = nullptr;
};

// An error of OpenGL since the last call, by name; empty when there was none.
std::string gl_error();

}  // namespace intaglio::window

// Dear ImGui in our window: its context, its font at the window's scale, and SDL's events as its input. All
// input comes by events (its own SDL back-end asks the real mouse, which no script can move).

union SDL_Event;

namespace intaglio::window {

class PanelHost {
 public:
  PanelHost(double scale, double density);
  ~PanelHost();
  PanelHost(const PanelHost&) = delete;
  PanelHost& operator=(const PanelHost&) = delete;

  // Hands over an event; whether a panel wants it for itself.
  bool take(const SDL_Event& event);
  // Between these two, panels are made; draw() puts them into the current framebuffer.
  void begin(const WindowSize& size, double seconds);
  void draw();

 private:
  bool pressed_[3] = {};  // since the last begin(), so that a short click is not lost
};

}  // namespace intaglio::window
