#include "intaglio/surface/texture_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <vector>

#include "intaglio/surface/image_file.h"

namespace intaglio::surface {

namespace fs = std::filesystem;

namespace {

enum class Role { normal_gl, normal_dx, normal, height, colour, other };

struct NamedRole {
  const char* part;
  Role role;
};

// In order: the first that occurs in the lower-case name decides.
constexpr std::array<NamedRole, 27> named_roles{{
    {"relief", Role::normal},       {"normalgl", Role::normal_gl}, {"normal_gl", Role::normal_gl},
    {"nor_gl", Role::normal_gl},    {"nrm_gl", Role::normal_gl},   {"normaldx", Role::normal_dx},
    {"normal_dx", Role::normal_dx}, {"nor_dx", Role::normal_dx},   {"nrm_dx", Role::normal_dx},
    {"normal", Role::normal},       {"_norm", Role::normal},       {"_nrm", Role::normal},
    {"_nor", Role::normal},         {"_nm", Role::normal},         {"disp", Role::height},
    {"height", Role::height},       {"bump", Role::height},        {"_ao", Role::other},
    {"rough", Role::other},         {"metal", Role::other},        {"spec", Role::other},
    {"arm", Role::other},           {"diff", Role::colour},        {"color", Role::colour},
    {"colour", Role::colour},       {"albedo", Role::colour},      {"basecol", Role::colour},
}};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// The role a file's name claims; an image whose name claims none is the colour map.
Role role_of(const fs::path& path) {
  const std::string stem = lower(path.stem().string());
  for (const NamedRole& named : named_roles) {
    if (stem.find(named.part) != std::string::npos) return named.role;
  }
  return Role::colour;
}

Result<TextureFiles> search_folder(const fs::path& folder) {
  std::vector<fs::path> images;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_regular_file(error) && has_image_extension(entry.path())) images.push_back(entry.path());
  }
  if (images.empty())
    return fail(folder.string(), "holds no PNG, JPEG, TGA or EXR image",
                "name a folder with a normal or height map");
  std::sort(images.begin(), images.end());  // the same choice on every machine
  TextureFiles files;
  const auto take = [&](Role role, fs::path& slot) {
    for (const fs::path& image : images) {
      if (slot.empty() && role_of(image) == role) slot = image;
    }
  };
  for (const Role role : {Role::normal_gl, Role::normal, Role::normal_dx}) take(role, files.normal);
  take(Role::height, files.height);
  take(Role::colour, files.colour);
  if (files.normal.empty() && files.height.empty()) {
    return fail(folder.string(), "no image is named as a normal or a height map",
                "name them like brick_normal.png and brick_height.png");
  }
  return files;
}

// The image of that role that lies beside `image` and shares its name but for the role; of several, the first
// by name.
fs::path beside(const fs::path& image, Role role) {
  std::error_code error;
  const std::string stem = lower(image.stem().string());
  const std::string shared = stem.substr(0, stem.find_last_of('_'));
  const fs::path folder = image.has_parent_path() ? image.parent_path() : fs::path(".");
  std::vector<fs::path> candidates;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path() == image || !entry.is_regular_file(error) || !has_image_extension(entry.path()))
      continue;
    const bool related = !shared.empty() && lower(entry.path().stem().string()).rfind(shared, 0) == 0;
    if (related && role_of(entry.path()) == role) candidates.push_back(entry.path());
  }
  std::sort(candidates.begin(), candidates.end());
  return candidates.empty() ? fs::path{} : candidates.front();
}

}  // namespace

bool named_directx(const fs::path& path) {
  return role_of(path) == Role::normal_dx;
}

Result<TextureFiles> find_texture_files(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return search_folder(path);
  return TextureFiles{path, beside(path, Role::height), beside(path, Role::colour)};
}

}  // namespace intaglio::surface
