#include "render/egl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <utility>
#include <fmt/format.h>

namespace intaglio::render {

namespace {

constexpr const char* where = "EGL";

Result<EGLDisplay> open_display() {
  // Asked before a display exists: only then are client extensions listed, and only the EXT entry point
  // resolves.
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
    return fail(where, "the surfaceless platform is missing",
                "install Mesa's EGL (libegl1, libegl-mesa0, libgl1-mesa-dri)");
  }
  const EGLDisplay display =
      eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  EGLint major = 0;
  EGLint minor = 0;
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, &major, &minor)) {
    return fail(where, fmt::format("no display could be initialised (error {:#x})", eglGetError()),
                "install a driver: Mesa's llvmpipe (libgl1-mesa-dri) needs no graphics card");
  }
  return display;
}

Result<EGLContext> open_context(EGLDisplay display) {
  const EGLint config_attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                      EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglBindAPI(EGL_OPENGL_API) || !eglChooseConfig(display, config_attributes, &config, 1, &count) ||
      count == 0) {
    return fail(where, "the display offers no desktop OpenGL",
                "a driver with OpenGL 3.3 core, such as Mesa, is needed");
  }
  const EGLint context_attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                       3,
                                       EGL_CONTEXT_MINOR_VERSION,
                                       3,
                                       EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                       EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                       EGL_NONE};
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, context_attributes);
  if (context == EGL_NO_CONTEXT) {
    return fail(where, fmt::format("no OpenGL 3.3 core context (error {:#x})", eglGetError()),
                "a driver with OpenGL 3.3 core, such as Mesa, is needed");
  }
  return context;
}

}  // namespace

Result<EglContext> EglContext::create() {
  const auto display = open_display();
  if (!display) return tl::unexpected(display.error());
  const auto context = open_context(*display);
  if (!context) return tl::unexpected(context.error());
  EglContext result(*display, *context);
  if (!eglMakeCurrent(*display, EGL_NO_SURFACE, EGL_NO_SURFACE, *context)) {
    return fail(where, "the context cannot be current without a surface",
                "EGL_KHR_surfaceless_context is needed");
  }
  return result;
}

EglContext::EglContext(EglContext&& other) noexcept
    : display_(other.display_), context_(std::exchange(other.context_, nullptr)) {}

EglContext& EglContext::operator=(EglContext&& other) noexcept {
  std::swap(display_, other.display_);
  std::swap(context_, other.context_);
  return *this;
}

EglContext::~EglContext() {
  if (!context_) return;
  release();
  eglDestroyContext(display_, context_);
}

void EglContext::make_current() const {
  if (eglGetCurrentContext() == context_) return;
  eglBindAPI(EGL_OPENGL_API);
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
}

void EglContext::release() const {
  if (eglGetCurrentContext() != context_) return;
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

std::string description_of_current() {
  return fmt::format("{}, OpenGL {}", reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                     reinterpret_cast<const char*>(glGetString(GL_VERSION)));
}

}  // namespace intaglio::render
