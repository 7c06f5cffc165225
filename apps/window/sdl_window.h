// A window with an OpenGL 3.3 core context, by SDL2. The context stays current in the thread that made it,
// which is the only one to use it.
#pragma once

#include <memory>
#include <string>

#include "intaglio/error.h"
#include "intaglio/image.h"

struct SDL_Window;
union SDL_Event;

namespace intaglio::window {

struct WindowSize {
  int width = 0, height = 0;                // framebuffer, pixels
  int window_width = 0, window_height = 0;  // in the units of mouse events
  // Panel scale factor, in the units of mouse events; 1 or more.
  double scale = 1;

  // Pixels in a unit of mouse events: 1, or more where the desktop itself scales (Wayland, macOS).
  double density() const { return double(width) / window_width; }
};

// The scale of panels for a display's dots an inch, in steps of a quarter; implausible values are treated as
// 96. Desktop scaling is not applied twice.
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
  // The picture drawn since the last swap: RGB, row 0 at the top.
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

// Dear ImGui in the window: its context (one a process), its font at the window's scale, and SDL's events as
// its input. Input comes only from events; ImGui's SDL back-end polls the real mouse, which scripts cannot
// drive.
class PanelHost {
 public:
  PanelHost(double scale, double density);
  ~PanelHost();
  PanelHost(const PanelHost&) = delete;
  PanelHost& operator=(const PanelHost&) = delete;

  // Returns true if ImGui captures the event.
  bool handle_event(const SDL_Event& event);
  // Panels are built between these two; draw() draws them into the current framebuffer.
  void begin(const WindowSize& size, double seconds);
  void draw();

 private:
  bool pressed_[3] = {};  // since the last begin(), so that a short click is not lost
};

}  // namespace intaglio::window
