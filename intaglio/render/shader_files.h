// The texts of the shaders by the names of their files: those built in, or a folder's in their place while
// one works on them.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "intaglio/core/error.h"

namespace intaglio::render {

using ShaderFiles = std::map<std::string, std::string>;

ShaderFiles embedded_shaders();

// The built-in ones, but for those that `folder` has a file for. Fails when it has none, or one that cannot
// be read.
Result<ShaderFiles> shaders_from(const std::filesystem::path& folder);

}  // namespace intaglio::render
