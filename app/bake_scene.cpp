// intaglio bake --scene SCENE -o DIR
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/bake_arguments.h"
#include "intaglio/session/scene_surface.h"
#include "intaglio/session/voices.h"

namespace intaglio::app {

int bake_scene(const BakeArguments& arguments, const Common& common) {
  namespace fs = std::filesystem;
  const auto scene = session::read_scene(arguments.scene);
  if (!scene) return report(scene.error());
  const auto surface = session::make_surface(*scene);
  if (!surface) return report(surface.error());
  std::error_code error;
  fs::create_directories(arguments.output, error);
  if (error || !fs::is_directory(arguments.output))
    return report({arguments.output, "is not a folder, and cannot be made one", "give -o another name"});
  const auto voices = session::bake_voices(*scene, *surface, {arguments.output, nullptr, ""});
  if (!voices) return report(voices.error());
  nlohmann::json list = nlohmann::json::array();
  for (const std::string& model : voices->models) {
    const fs::path file = fs::path(arguments.output) / (model + ".modes");
    if (!fs::exists(file)) return report({file.string(), "could not be written", "is the disk full?"});
    list.push_back(file.string());
  }
  if (arguments.json) {
    fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else if (!common.quiet) {
    fmt::print("{}: {} models, {} of them baked now\n", arguments.output, list.size(), voices->baked);
  }
  return 0;
}

}  // namespace intaglio::app
