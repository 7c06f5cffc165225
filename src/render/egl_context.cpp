#include "render/egl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <fmt/format.h>
#include <utility>

namespace intaglio::render {

namespace {

constexpr const char* where = "EGL";

Result<EGLDisplay> open_display() {
  // Without this test epoxy would abort the process.
  if (!epoxy_has_egl())
    return fail(where, "libEGL.so.1 is not installed", "install libegl1 and libgl1-mesa-dri");
  // Client extensions are listed only while no display exists, and only the EXT entry point resolves then.
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
    return fail(where, "the EGL display has no desktop OpenGL configuration",
                "a driver with OpenGL 3.3 core, such as Mesa, is needed");
  }
  // clang-format off
  const EGLint context_attributes[] = {
      EGL_CONTEXT_MAJOR_VERSION, 3,
      EGL_CONTEXT_MINOR_VERSION, 3,
      EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
      EGL_NONE};
  // clang-format on
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
  const EGLenum api = eglQueryAPI();  // the calling thread's, which open_context() changes
  const auto context = open_context(*display);
  eglBindAPI(api);
  if (!context) return tl::unexpected(context.error());
  EglContext result(*display, *context);
  if (!CurrentContext(result)) {
    return fail(where, "the context cannot be made current without a surface",
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
  if (context_) eglDestroyContext(display_, context_);
}

CurrentContext::Binding CurrentContext::current() {
  return {eglQueryAPI(), eglGetCurrentDisplay(), eglGetCurrentSurface(EGL_DRAW),
          eglGetCurrentSurface(EGL_READ), eglGetCurrentContext()};
}

// EGL keeps the API (OpenGL or OpenGL ES) per thread, too.
CurrentContext::CurrentContext(const EglContext& context) : display_(context.display_), previous_(current()) {
  eglBindAPI(EGL_OPENGL_API);
  ok_ = eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_) == EGL_TRUE;
}

CurrentContext::~CurrentContext() {
  const Binding& p = previous_;
  if (p.context == EGL_NO_CONTEXT) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  } else {
    eglMakeCurrent(p.display, p.draw, p.read, p.context);
  }
  eglBindAPI(p.api);
}

std::string description_of_current() {
  return fmt::format("{}, OpenGL {}", reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                     reinterpret_cast<const char*>(glGetString(GL_VERSION)));
}

}  // namespace intaglio::render
