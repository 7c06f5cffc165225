// An OpenGL 3.3 core context without a window system: EGL on Mesa's surfaceless platform, so pictures come
// out the same on a server, in a test and on a desk. Drawing goes to framebuffer objects; there is no default
// framebuffer.
//
// A context is current in one thread at a time; the RAII class CurrentContext makes it current for a scope
// and then restores what was current before. Creating a context costs 30 to 200 ms. The EGL display is shared
// by the process and stays initialised. Source: EGL 1.5, EGL_MESA_platform_surfaceless.
#pragma once

#include <string>

#include "intaglio/error.h"

namespace intaglio::render {

class EglContext {
 public:
  // A new context, current in no thread; or why there is none (no EGL platform, no OpenGL 3.3).
  static Result<EglContext> create();

  EglContext(EglContext&& other) noexcept;
  EglContext& operator=(EglContext&& other) noexcept;
  ~EglContext();

 private:
  friend class CurrentContext;
  EglContext(void* display, void* context) : display_(display), context_(context) {}

  void* display_;  // EGLDisplay
  void* context_;  // EGLContext; null when moved from
};

// Makes a context current in this thread for as long as this lives, then restores the thread's EGL context of
// before, if there was one. The context may be moved meanwhile.
class CurrentContext {
 public:
  explicit CurrentContext(const EglContext& context);
  ~CurrentContext();
  CurrentContext(const CurrentContext&) = delete;
  CurrentContext& operator=(const CurrentContext&) = delete;

  // False when the driver cannot make a context current without a surface.
  explicit operator bool() const { return ok_; }

 private:
  struct Binding {
    unsigned api;                           // EGLenum
    void *display, *draw, *read, *context;  // EGLDisplay, two of EGLSurface, EGLContext
  };
  static Binding current();

  void* display_;
  Binding previous_;
  bool ok_;
};

// "llvmpipe ..., OpenGL ...", for logs and reports: the driver of the context that is current, EGL or not.
std::string description_of_current();

}  // namespace intaglio::render
