// A scene file: surfaces, bodies, a pen, sound and camera, in TOML (docs/scene.md has every key).
//
//   auto scene = intaglio::Scene::load("scenes/brick.toml");
//   if (!scene) { std::cerr << scene.error() << '\n'; return 1; }     // names file and line
//
// A handle to immutable data: copies are cheap; any thread. session.h runs it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "intaglio/error.h"
#include "intaglio/representation.h"
#include "intaglio/surface.h"

namespace intaglio {

class Scene {
 public:
  static Result<Scene> load(const std::filesystem::path& path);
  // From text; `name` stands for the file in errors, and its folder is where textures and models are looked
  // for.
  static Result<Scene> parse(std::string_view text, const std::string& name);

  const std::string& title() const;
  double duration() const;  // s
  Representation representation() const;
  std::size_t body_count() const;  // balls, then other bodies; their BodyIds are 1, 2, ...
  bool has_pen() const;
  // Copies of the scene with one setting changed.
  Scene with_duration(double seconds) const;
  Scene with_representation(Representation representation) const;
  Scene with_texture(const std::string& texture) const;  // on the floor; as Surface::load takes it
  Scene with_picture(int width, int height, int fps) const;
  // Bytes that making and running the scene may take (docs/trust.md); beyond it is an error.
  Scene with_allowed_memory(std::uint64_t bytes) const;

  // The floor, when it is a rectangle: made anew at each call. Tenths of a second.
  Result<Surface> floor() const;

  struct Impl;  // of the library
  explicit Scene(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace intaglio
