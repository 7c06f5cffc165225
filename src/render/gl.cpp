#include "render/gl.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <cstddef>
#include <vector>

namespace intaglio::render::gl {

namespace {

constexpr const char* version_line = "#version 330 core\n";

// The beginning of a compiler's log, as one line.
std::string one_line(std::string log) {
  constexpr std::size_t enough = 400;
  if (log.size() > enough) log = log.substr(0, enough) + " ...";
  while (!log.empty() && (log.back() == '\n' || log.back() == '\0')) log.pop_back();
  std::replace(log.begin(), log.end(), '\n', ' ');
  return log;
}

template <class GetInteger, class GetLog>
std::string info_log(GLuint object, GetInteger get_integer, GetLog get_log) {
  GLint length = 0;
  get_integer(object, GL_INFO_LOG_LENGTH, &length);
  std::string log(std::size_t(std::max(length, 1)), '\0');
  get_log(object, length, nullptr, log.data());
  return one_line(log);
}

// The compiler writes a line as "source:line(column)": replaces the number of the source at the beginning of
// a word by its file's name.
std::string with_file_names(const std::string& log, const Program::Sources& sources) {
  std::string out;
  for (std::size_t k = 0; k < log.size();) {
    const bool begins = k == 0 || log[k - 1] == ' ';
    const std::size_t colon = log.find_first_not_of("0123456789", k);
    const bool is_place = begins && colon != k && colon != std::string::npos && log[colon] == ':' &&
                          colon - k < 4 &&
                          std::isdigit(static_cast<unsigned char>(log[std::min(colon + 1, log.size() - 1)]));
    const std::size_t source = is_place ? std::stoul(log.substr(k, colon - k)) : sources.size();
    if (source < sources.size()) {
      out += sources[source].file;
      k = colon;
    } else {
      out += log[k++];
    }
  }
  return out;
}

Result<Handle<delete_shader>> compile(GLenum stage, const std::string& name,
                                      const Program::Sources& sources) {
  std::string joined = version_line;
  int number = 0;
  for (const Program::SourceFile& s : sources) joined += fmt::format("#line 1 {}\n{}\n", number++, s.text);
  const char* text = joined.c_str();
  Handle<delete_shader> shader(glCreateShader(stage));
  glShaderSource(shader.get(), 1, &text, nullptr);
  glCompileShader(shader.get());
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &compiled);
  if (!compiled) {
    return fail(fmt::format("{} {} shader", name, stage == GL_VERTEX_SHADER ? "vertex" : "fragment"),
                "does not compile: " +
                    with_file_names(info_log(shader.get(), glGetShaderiv, glGetShaderInfoLog), sources),
                "the built-in shaders compile on any GLSL 3.30 driver");
  }
  return shader;
}

}  // namespace

Result<Program> Program::create(std::string name, const Sources& vertex, const Sources& fragment) {
  const auto vertex_shader = compile(GL_VERTEX_SHADER, name, vertex);
  if (!vertex_shader) return tl::unexpected(vertex_shader.error());
  const auto fragment_shader = compile(GL_FRAGMENT_SHADER, name, fragment);
  if (!fragment_shader) return tl::unexpected(fragment_shader.error());
  Program result;
  result.program_ = Handle<delete_program>(glCreateProgram());
  const GLuint program = result.program_.get();
  glAttachShader(program, vertex_shader->get());
  glAttachShader(program, fragment_shader->get());
  glLinkProgram(program);
  GLint linked = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (!linked)
    return fail(name + " shader", "does not link: " + info_log(program, glGetProgramiv, glGetProgramInfoLog),
                "a GLSL 3.30 driver is needed");
  return result;
}

void Program::bind_block(const char* block, GLuint binding) const {
  const GLuint index = glGetUniformBlockIndex(program_.get(), block);
  if (index != GL_INVALID_INDEX) glUniformBlockBinding(program_.get(), index, binding);
}

Texture::Texture(int width, int height, const TextureFormat& format, const void* data) {
  GLuint name = 0;
  glGenTextures(1, &name);
  texture_ = Handle<delete_texture>(name);
  set_level(0, width, height, format, data);
  set_filter(GL_NEAREST, GL_NEAREST);
  set_edge(GL_CLAMP_TO_EDGE);
}

void Texture::bind(int unit) const {
  glActiveTexture(GL_TEXTURE0 + GLenum(unit));
  glBindTexture(GL_TEXTURE_2D, texture_.get());
}

void Texture::set_filter(GLint minify, GLint magnify) {
  bind(0);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, minify);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, magnify);
}

void Texture::set_edge(GLint wrap_mode) {
  bind(0);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap_mode);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap_mode);
}

void Texture::make_mipmaps() {
  bind(0);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 1000);
  glGenerateMipmap(GL_TEXTURE_2D);
}

void Texture::set_level(int level, int width, int height, const TextureFormat& format, const void* data) {
  bind(0);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, level, format.internal, width, height, 0, format.format, format.type, data);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, level);
}

Result<Framebuffer> Framebuffer::create(int width, int height, GLint colour_format, bool with_depth) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  if (width < 1 || height < 1 || width > limit || height > limit) {
    return fail("renderer", fmt::format("cannot create a framebuffer of {} x {} samples", width, height),
                fmt::format("sides must be 1 to {}, supersampling included", limit));
  }
  Framebuffer result;
  result.width_ = width;
  result.height_ = height;
  GLuint name = 0;
  glGenFramebuffers(1, &name);
  result.framebuffer_ = Handle<delete_framebuffer>(name);
  glBindFramebuffer(GL_FRAMEBUFFER, name);
  result.colour_ = Texture(width, height, {colour_format, GL_RGBA, GL_UNSIGNED_BYTE}, nullptr);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, result.colour_.name(), 0);
  if (with_depth) {
    result.depth_ = Texture(width, height, {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT}, nullptr);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, result.depth_.name(), 0);
  }
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    return fail("renderer", fmt::format("framebuffer incomplete (status {:#x})", status),
                "a driver with OpenGL 3.3 core, such as Mesa, is needed");
  }
  return result;
}

void Framebuffer::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glViewport(0, 0, width_, height_);
}

VertexArray::VertexArray() {
  GLuint name = 0;
  glGenVertexArrays(1, &name);
  array_ = Handle<delete_vertex_array>(name);
}

VertexArray::VertexArray(const Mesh& mesh) : VertexArray() {
  GLuint names[3] = {};
  glGenBuffers(3, names);
  vertices_ = Handle<delete_buffer>(names[0]);
  indices_ = Handle<delete_buffer>(names[1]);
  instances_ = Handle<delete_buffer>(names[2]);
  count_ = GLsizei(mesh.indices.size());
  const auto bytes = [](const auto& v) { return GLsizeiptr(v.size() * sizeof v[0]); };
  bytes_ = std::size_t(bytes(mesh.vertices) + bytes(mesh.indices));
  glBindVertexArray(array_.get());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.get());
  glBufferData(GL_ARRAY_BUFFER, bytes(mesh.vertices), mesh.vertices.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.get());
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, bytes(mesh.indices), mesh.indices.data(), GL_STATIC_DRAW);
  const auto offset = [](std::size_t at) { return reinterpret_cast<const void*>(at); };
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), offset(offsetof(Vertex, position)));
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), offset(offsetof(Vertex, normal)));
  glBindBuffer(GL_ARRAY_BUFFER, instances_.get());
  for (GLuint k = 2; k <= 8; ++k) {
    glEnableVertexAttribArray(k);
    glVertexAttribDivisor(k, 1);
  }
  for (GLuint column = 0; column < 4; ++column)
    glVertexAttribPointer(2 + column, 4, GL_FLOAT, GL_FALSE, sizeof(Instance),
                          offset(offsetof(Instance, model) + column * 4 * sizeof(float)));
  glVertexAttribPointer(6, 3, GL_FLOAT, GL_FALSE, sizeof(Instance), offset(offsetof(Instance, colour_a)));
  glVertexAttribPointer(7, 3, GL_FLOAT, GL_FALSE, sizeof(Instance), offset(offsetof(Instance, colour_b)));
  glVertexAttribIPointer(8, 1, GL_INT, sizeof(Instance), offset(offsetof(Instance, self)));
}

void VertexArray::draw(std::span<const Instance> instances) {
  if (instances.empty()) return;
  glBindVertexArray(array_.get());
  glBindBuffer(GL_ARRAY_BUFFER, instances_.get());
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(instances.size_bytes()), instances.data(), GL_STREAM_DRAW);
  glDrawElementsInstanced(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr, GLsizei(instances.size()));
}

void VertexArray::draw_unindexed(int count) const {
  glBindVertexArray(array_.get());
  glDrawArrays(GL_TRIANGLES, 0, count);
}

InstanceArray::InstanceArray(int attributes, std::span<const float> data)
    : count_(GLsizei(data.size()) / (3 * attributes)), bytes_(data.size_bytes()) {
  GLuint array = 0, buffer = 0;
  glGenVertexArrays(1, &array);
  array_ = Handle<delete_vertex_array>(array);
  glGenBuffers(1, &buffer);
  instances_ = Handle<delete_buffer>(buffer);
  glBindVertexArray(array);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(bytes_), data.data(), GL_STATIC_DRAW);
  const auto stride = GLsizei(3 * sizeof(float));
  for (int k = 0; k < attributes; ++k) {
    const auto at = reinterpret_cast<const void*>(std::size_t(k * stride));
    glEnableVertexAttribArray(GLuint(k));
    glVertexAttribPointer(GLuint(k), 3, GL_FLOAT, GL_FALSE, attributes * stride, at);
    glVertexAttribDivisor(GLuint(k), 1);
  }
}

void InstanceArray::draw() const {
  glBindVertexArray(array_.get());
  glDrawArraysInstanced(GL_TRIANGLES, 0, 12, count_);
}

UniformBuffer::UniformBuffer(GLuint binding, GLsizeiptr bytes) : bytes_(bytes) {
  GLuint name = 0;
  glGenBuffers(1, &name);
  buffer_ = Handle<delete_buffer>(name);
  glBindBuffer(GL_UNIFORM_BUFFER, name);
  glBufferData(GL_UNIFORM_BUFFER, bytes, nullptr, GL_DYNAMIC_DRAW);
  glBindBufferBase(GL_UNIFORM_BUFFER, binding, name);
}

void UniformBuffer::write(const void* data) {
  glBindBuffer(GL_UNIFORM_BUFFER, buffer_.get());
  glBufferSubData(GL_UNIFORM_BUFFER, 0, bytes_, data);
}

}  // namespace intaglio::render::gl
