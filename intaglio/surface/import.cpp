#include "intaglio/surface/import.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "intaglio/surface/image_file.h"

namespace intaglio::surface {

namespace fs = std::filesystem;

namespace {

// ---- which file is what ---------------------------------------------------------------------------------------------

enum class Role { normal_gl, normal_dx, normal, height, colour, other };

struct NamedRole {
  const char* part;
  Role role;
};

// In order: the first that occurs in the lower-case name decides.
constexpr std::array<NamedRole, 26> named_roles{{
    {"normalgl", Role::normal_gl}, {"normal_gl", Role::normal_gl}, {"nor_gl", Role::normal_gl}, {"nrm_gl", Role::normal_gl},
    {"normaldx", Role::normal_dx}, {"normal_dx", Role::normal_dx}, {"nor_dx", Role::normal_dx}, {"nrm_dx", Role::normal_dx},
    {"normal", Role::normal},      {"_norm", Role::normal},        {"_nrm", Role::normal},      {"_nor", Role::normal},
    {"_nm", Role::normal},         {"disp", Role::height},         {"height", Role::height},    {"bump", Role::height},
    {"_ao", Role::other},          {"rough", Role::other},         {"metal", Role::other},      {"spec", Role::other},
    {"arm", Role::other},          {"diff", Role::colour},         {"color", Role::colour},     {"colour", Role::colour},
    {"albedo", Role::colour},      {"basecol", Role::colour},
}};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_image(const fs::path& path) {
  const std::string extension = lower(path.extension().string());
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

// The role a file's name claims; an image whose name claims none is the colour map.
Role role_of(const fs::path& path) {
  const std::string stem = lower(path.stem().string());
  for (const NamedRole& named : named_roles) {
    if (stem.find(named.part) != std::string::npos) return named.role;
  }
  return Role::colour;
}

struct Files {
  fs::path normal, height, colour;
};

Result<Files> search_folder(const fs::path& folder) {
  std::vector<fs::path> images;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_regular_file(error) && is_image(entry.path())) images.push_back(entry.path());
  }
  if (images.empty()) return fail(folder.string(), "holds no PNG or JPEG image", "name a folder with a normal or height map");
  std::sort(images.begin(), images.end());  // the same choice on every machine
  Files files;
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

// The colour map that lies beside a single image: the same name with its role cut off, or with a colour role.
fs::path colour_beside(const fs::path& image) {
  std::error_code error;
  const std::string stem = lower(image.stem().string());
  const fs::path folder = image.has_parent_path() ? image.parent_path() : fs::path(".");
  std::vector<fs::path> candidates;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path() == image || !entry.is_regular_file(error) || !is_image(entry.path())) continue;
    const std::string other = lower(entry.path().stem().string());
    const std::string shared = stem.substr(0, stem.find_last_of('_'));
    if (role_of(entry.path()) == Role::colour && !shared.empty() && other.rfind(shared, 0) == 0) candidates.push_back(entry.path());
  }
  std::sort(candidates.begin(), candidates.end());
  return candidates.empty() ? fs::path{} : candidates.front();
}

// ---- what the pixels are --------------------------------------------------------------------------------------------

// Normal maps have vectors of nearly unit length that point up.
bool looks_like_normals(const Image16& image) {
  std::size_t unit = 0;
  const std::size_t pixels = image.data.size() / std::size_t(image.channels);
  for (std::size_t p = 0; p < pixels; ++p) {
    Vec3 n;
    for (int c = 0; c < 3; ++c) n[c] = image.data[p * std::size_t(image.channels) + std::size_t(c)] / 32767.5 - 1;
    if (std::abs(n.norm() - 1) < 0.15 && n.z() > 0) ++unit;
  }
  return unit * 10 > pixels * 8;
}

bool is_constant(const Image16& image, int channel) {
  const auto step = static_cast<std::size_t>(image.channels);
  const std::uint16_t first = image.data[static_cast<std::size_t>(channel)];
  for (std::size_t p = static_cast<std::size_t>(channel); p < image.data.size(); p += step) {
    if (image.data[p] != first) return false;
  }
  return true;
}

// Row y of an image (0 = top) as a row of texels (0 = bottom).
int flipped(int y, int height) { return height - 1 - y; }

std::vector<Vec3> read_normals(const Image16& image, Green green) {
  std::vector<Vec3> normals(std::size_t(image.width) * std::size_t(image.height));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      Vec3 n;
      for (int c = 0; c < 3; ++c) n[c] = image.at(x, y, c) / 32767.5 - 1;
      if (green == Green::minus_y) n.y() = -n.y();
      n.z() = std::max(n.z(), 1e-3);  // a height field has no overhangs; 8-bit files round vertical walls to below 0
      normals[std::size_t(flipped(y, image.height)) * std::size_t(image.width) + std::size_t(x)] = n.normalized();
    }
  }
  return normals;
}

std::vector<float> read_depth(const Image16& image, int channel, Polarity polarity) {
  std::vector<float> depth(std::size_t(image.width) * std::size_t(image.height));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      double value = image.at(x, y, channel) / 65535.0;
      if (image.channels == 3) value = (image.at(x, y, 0) + image.at(x, y, 1) + image.at(x, y, 2)) / (3 * 65535.0);
      depth[std::size_t(flipped(y, image.height)) * std::size_t(image.width) + std::size_t(x)] =
          static_cast<float>(polarity == Polarity::height ? 1 - value : value);
    }
  }
  return depth;
}

Image8 read_colour(const Image16& image) {
  Image8 colour(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        colour.at(x, flipped(y, image.height), c) = static_cast<std::uint8_t>(image.at(x, y, image.channels < 3 ? 0 : c) >> 8);
      }
    }
  }
  return colour;
}

Image8 plain_colour() {
  Image8 colour(1, 1, 3);
  std::fill(colour.data.begin(), colour.data.end(), std::uint8_t{176});
  return colour;
}

// Normals of a depth map by central differences, for a tile whose full depth is `depth_fraction` of its width.
std::vector<Vec3> normals_of_depth(const std::vector<float>& depth, int width, int height, double depth_fraction) {
  std::vector<Vec3> normals(depth.size());
  const auto z = [&](int i, int j) {
    return -depth_fraction * static_cast<double>(depth[std::size_t((j + height) % height) * std::size_t(width) + std::size_t((i + width) % width)]);
  };
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const double dz_dx = (z(i + 1, j) - z(i - 1, j)) * width / 2;
      const double dz_dy = (z(i, j + 1) - z(i, j - 1)) * width / 2;  // texels are square
      normals[std::size_t(j) * std::size_t(width) + std::size_t(i)] = Vec3(-dz_dx, -dz_dy, 1).normalized();
    }
  }
  return normals;
}

// ---- putting it together --------------------------------------------------------------------------------------------

struct Loaded {
  fs::path normal_file, height_file;
  Image16 normal;         // RGB or RGBA; empty: none
  Image16 height;         // empty: none
  int height_channel = 0;
  Polarity default_polarity = Polarity::height;
};

Result<Loaded> load_folder(const Files& files) {
  Loaded loaded{files.normal, files.height, {}, {}};
  if (!files.normal.empty()) {
    auto image = read_image(files.normal);
    if (!image) return tl::unexpected(image.error());
    if (image->pixels.channels < 3) return fail(files.normal.string(), "is a grey image, but its name says normal map", "rename it");
    loaded.normal = std::move(image->pixels);
  }
  if (!files.height.empty()) {
    auto image = read_image(files.height);
    if (!image) return tl::unexpected(image.error());
    loaded.height = std::move(image->pixels);
  } else if (loaded.normal.channels == 4 && !is_constant(loaded.normal, 3)) {
    loaded.height = loaded.normal;
    loaded.height_file = files.normal;
    loaded.height_channel = 3;
    loaded.default_polarity = Polarity::depth;
  }
  return loaded;
}

Result<Loaded> load_single(const fs::path& path) {
  auto image = read_image(path);
  if (!image) return tl::unexpected(image.error());
  Loaded loaded;
  if (image->pixels.channels >= 3 && looks_like_normals(image->pixels)) {
    loaded.normal_file = path;
    loaded.normal = image->pixels;
    if (image->pixels.channels == 4 && !is_constant(image->pixels, 3)) {
      loaded.height_file = path;
      loaded.height = std::move(image->pixels);
      loaded.height_channel = 3;
      loaded.default_polarity = Polarity::depth;
    }
  } else {
    loaded.height_file = path;
    loaded.height = std::move(image->pixels);
  }
  return loaded;
}

Result<Imported> convert(Loaded loaded, const fs::path& colour_file, const ImportOptions& options) {
  Imported out;
  const Image16& size_from = loaded.normal.empty() ? loaded.height : loaded.normal;
  out.texels.width = size_from.width;
  out.texels.height = size_from.height;
  if (!loaded.height.empty()) {
    const Polarity polarity = options.polarity.value_or(loaded.default_polarity);
    if (loaded.height.width != size_from.width || loaded.height.height != size_from.height) {
      return fail(loaded.height_file.string(), fmt::format("is {} x {}, but its normal map {} is {} x {}", loaded.height.width, loaded.height.height, loaded.normal_file.string(), size_from.width, size_from.height), "resize one to the other");
    }
    out.texels.depth = read_depth(loaded.height, loaded.height_channel, polarity);
    out.notes.push_back(fmt::format("{} from {}{}", polarity == Polarity::height ? "height (white = high)" : "depth (white = deep)", loaded.height_file.filename().string(), loaded.height_channel == 3 ? ", alpha channel" : ""));
  }
  if (!loaded.normal.empty()) {
    const Green by_name = role_of(loaded.normal_file) == Role::normal_dx ? Green::minus_y : Green::plus_y;
    const Green green = options.green.value_or(by_name);
    out.texels.normal = read_normals(loaded.normal, green);
    out.notes.push_back(fmt::format("normals from {}, green {}", loaded.normal_file.filename().string(), green == Green::plus_y ? "+Y" : "-Y"));
  } else {
    out.texels.normal = normals_of_depth(out.texels.depth, out.texels.width, out.texels.height, options.depth_fraction);
    out.notes.push_back("normals from the slopes of the height");
  }
  out.texels.colour = plain_colour();
  if (!colour_file.empty()) {
    const auto colour = read_image(colour_file);
    if (!colour) return tl::unexpected(colour.error());
    out.texels.colour = read_colour(colour->pixels);
    out.notes.push_back("colour from " + colour_file.filename().string());
  } else {
    out.notes.push_back("no colour map found: plain grey");
  }
  return out;
}

}  // namespace

Result<Imported> import_texture(const fs::path& path, const ImportOptions& options) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    const auto files = search_folder(path);
    if (!files) return tl::unexpected(files.error());
    auto loaded = load_folder(*files);
    if (!loaded) return tl::unexpected(loaded.error());
    return convert(std::move(*loaded), files->colour, options);
  }
  auto loaded = load_single(path);
  if (!loaded) return tl::unexpected(loaded.error());
  return convert(std::move(*loaded), colour_beside(path), options);
}

Texels to_texels(const TextureImages& images) {
  return {images.relief.width, images.relief.height, read_depth(images.relief, 3, Polarity::depth),
          read_normals(images.relief, Green::plus_y), [&] {
            Image8 colour(images.colour.width, images.colour.height, 3);
            for (int y = 0; y < colour.height; ++y) {
              for (int x = 0; x < colour.width; ++x) {
                for (int c = 0; c < 3; ++c) colour.at(x, flipped(y, colour.height), c) = images.colour.at(x, y, c);
              }
            }
            return colour;
          }()};
}

}  // namespace intaglio::surface
