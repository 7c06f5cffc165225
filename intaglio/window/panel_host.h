// Dear ImGui in our window: its context, its font at the window's scale, and SDL's events as its input. All
// input comes by events (its own SDL back-end asks the real mouse, which no script can move).
#pragma once

#include <string>

#include "intaglio/window/sdl_window.h"

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
