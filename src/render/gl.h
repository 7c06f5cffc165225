// The few OpenGL objects a picture needs, each owned by one C++ object that can be moved but not copied.
//
// All of this needs a current context (egl_context.h) when it is made, used and destroyed, and one thread.
// Private to render/ and its tests: nothing else includes OpenGL.
#pragma once

#include <epoxy/gl.h>

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "intaglio/error.h"
#include "render/mesh.h"

namespace intaglio::render::gl {

// A GL name with the function that deletes it; 0 owns nothing.
template <void (*destroy)(GLuint)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(GLuint name) : name_(name) {}
  Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~Handle() {
    if (name_) destroy(name_);
  }
  GLuint get() const { return name_; }

 private:
  GLuint name_ = 0;
};

inline void delete_program(GLuint name) {
  glDeleteProgram(name);
}
inline void delete_shader(GLuint name) {
  glDeleteShader(name);
}
inline void delete_texture(GLuint name) {
  glDeleteTextures(1, &name);
}
inline void delete_framebuffer(GLuint name) {
  glDeleteFramebuffers(1, &name);
}
inline void delete_buffer(GLuint name) {
  glDeleteBuffers(1, &name);
}
inline void delete_vertex_array(GLuint name) {
  glDeleteVertexArrays(1, &name);
}

// A linked vertex and fragment shader. Each is made of source files, joined after the #version line.
class Program {
 public:
  struct SourceFile {
    std::string file, text;  // an error names file and line
  };
  using Sources = std::vector<SourceFile>;

  // `name` is for the error, which holds the compiler's log in one line.
  static Result<Program> create(std::string name, const Sources& vertex, const Sources& fragment);

  void use() const { glUseProgram(program_.get()); }
  // These set a uniform by name; one that the compiler found unused is ignored. The program must be in use.
  void set(const char* uniform, int value) const { glUniform1i(location(uniform), value); }
  void set(const char* uniform, const Eigen::Vector3f& v) const {
    glUniform3fv(location(uniform), 1, v.data());
  }
  void set(const char* uniform, const Eigen::Matrix4f& m) const {
    glUniformMatrix4fv(location(uniform), 1, GL_FALSE, m.data());
  }
  // Ties a std140 uniform block to a binding point.
  void bind_block(const char* block, GLuint binding) const;

 private:
  GLint location(const char* uniform) const { return glGetUniformLocation(program_.get(), uniform); }

  Handle<delete_program> program_;
};

// The format of a 2-D texture and of the data uploaded to it.
struct TextureFormat {
  GLint internal;  // GL_R32F, ...
  GLenum format;   // of the uploaded data: GL_RED, ...
  GLenum type;     // GL_FLOAT, ...
};

class Texture {
 public:
  Texture() = default;
  // Rows bottom first, tightly packed; null leaves the texels undefined. Nearest, clamped, one level.
  Texture(int width, int height, const TextureFormat& format, const void* data);

  void bind(int unit) const;
  void set_filter(GLint minify, GLint magnify);
  void set_edge(GLint wrap_mode);
  void make_mipmaps();
  // Uploads mip level `level` and makes it the last.
  void set_level(int level, int width, int height, const TextureFormat& format, const void* data);
  GLuint name() const { return texture_.get(); }

 private:
  Handle<delete_texture> texture_;
};

// A render target: a colour texture and, optionally, a 32-bit float depth texture.
class Framebuffer {
 public:
  Framebuffer() = default;
  static Result<Framebuffer> create(int width, int height, GLint colour_format, bool with_depth);

  // Makes this the render target, with a viewport over all of it.
  void bind() const;
  const Texture& colour() const { return colour_; }
  GLuint name() const { return framebuffer_.get(); }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  int width_ = 0;
  int height_ = 0;
  Texture colour_;
  Texture depth_;
  Handle<delete_framebuffer> framebuffer_;
};

// One body of a mesh that many have: attributes 2 to 8 (shaders/solid.vert).
struct Instance {
  Eigen::Matrix4f model = Eigen::Matrix4f::Identity();
  Eigen::Vector3f colour_a = Eigen::Vector3f::Zero(), colour_b = Eigen::Vector3f::Zero();
  GLint self = -1;  // index among the shadow casters, or -1
};

// Triangles on the device: attribute 0 is the position, 1 the normal.
class VertexArray {
 public:
  VertexArray();  // no attributes: for vertices generated in the vertex shader
  explicit VertexArray(const Mesh& mesh);

  // All bodies of this mesh in one call: thousands cost the driver what one does.
  void draw(std::span<const Instance> instances);
  std::size_t bytes() const { return bytes_; }  // of vertices and indices
  // `count` vertices numbered by gl_VertexID alone.
  void draw_unindexed(int count) const;

 private:
  Handle<delete_vertex_array> array_;
  Handle<delete_buffer> vertices_;
  Handle<delete_buffer> indices_;
  Handle<delete_buffer> instances_;
  GLsizei count_ = 0;
  std::size_t bytes_ = 0;
};

// Instanced 12-vertex geometry with `attributes` vec3 per instance.
class InstanceArray {
 public:
  InstanceArray(int attributes, std::span<const float> data);
  void draw() const;
  std::size_t bytes() const { return bytes_; }

 private:
  Handle<delete_vertex_array> array_;
  Handle<delete_buffer> instances_;
  GLsizei count_ = 0;
  std::size_t bytes_ = 0;
};

// A uniform block's storage at one binding point.
class UniformBuffer {
 public:
  UniformBuffer(GLuint binding, GLsizeiptr bytes);
  void write(const void* data);  // all of it

 private:
  Handle<delete_buffer> buffer_;
  GLsizeiptr bytes_;
};

}  // namespace intaglio::render::gl
