// Scenes within other files, such as the designs of studies, which change a scene's keys from trial to trial.
#pragma once

#include <filesystem>
#include <string>

#include "core/toml.h"
#include "scene/scene.h"

namespace intaglio::scene {

// The scene that a parsed table says; `name` is the file, for errors.
Result<Scene> scene_of_table(const toml::table& table, const std::string& name);

// Names of textures and meshes that do not exist relative to the working folder are looked for in `folder`.
void find_files_beside(Scene& scene, const std::filesystem::path& folder);

}  // namespace intaglio::scene
