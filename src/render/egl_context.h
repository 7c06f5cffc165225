// An OpenGL 3.3 core context without a window system: EGL on Mesa's surfaceless platform, so pictures come
// out the same on a server, in a test and on a desk. Drawing goes to framebuffer objects; there is no default
// framebuffer.
//
// A context is current in one thread at a time: whoever makes it current lets it go again, by scope
// (Current), so that another thread can have it. Creating one costs 30 to 200 ms. The EGL display is shared
// by the process and stays initialised. Source: EGL 1.5, EGL_MESA_platform_surfaceless.
#pragma once

#include <string>

#include "intaglio/error.h"

namespace intaglio::render {

class EglContext {
 public:
  // A new context, current in the calling thread; or why there is none (no EGL platform, no OpenGL 3.3).
  static Result<EglContext> create();

  EglContext(EglContext&& other) noexcept;
  EglContext& operator=(EglContext&& other) noexcept;
  ~EglContext();

  void make_current() const;
  void release() const;

 private:
  EglContext(void* display, void* context) : display_(display), context_(context) {}

  void* display_;  // EGLDisplay
  void* context_;  // EGLContext; null when moved from
};

// "llvmpipe ..., OpenGL ...", of the context that is current, whoever made it: for logs and reports.
std::string description_of_current();

// A context is current in this thread for as long as this lives.
class Current {
 public:
  explicit Current(const EglContext& context) : context_(context) { context_.make_current(); }
  ~Current() { context_.release(); }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  const EglContext& context_;
};

}  // namespace intaglio::render
