#include "surface/import.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/output_files.h"
#include "core/text.h"
#include "surface/fuse.h"
#include "surface/image/image_file.h"
#include "surface/maps.h"
#include "surface/recipes/builtin.h"

namespace intaglio::surface {

namespace fs = std::filesystem;

namespace {

constexpr double default_depth_fraction = 0.02;

// --- Files ---

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

// The role a file's name claims; an image whose name claims none is the colour map.
Role role_of(const fs::path& path) {
  const std::string stem = lower_case(path.stem().string());
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
    return fail(folder.string(), "contains no PNG, JPEG, TGA or EXR image",
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
    return fail(folder.string(), "no file name marks a normal or height map",
                "name them like brick_normal.png and brick_height.png");
  }
  return files;
}

// The companion image with this role and the same base name; of several, the first in name order.
fs::path companion_file(const fs::path& image, Role role) {
  std::error_code error;
  const std::string stem = lower_case(image.stem().string());
  const std::string shared = stem.substr(0, stem.find_last_of('_'));
  const fs::path folder = image.has_parent_path() ? image.parent_path() : fs::path(".");
  std::vector<fs::path> candidates;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path() == image || !entry.is_regular_file(error) || !has_image_extension(entry.path()))
      continue;
    const bool related = !shared.empty() && lower_case(entry.path().stem().string()).rfind(shared, 0) == 0;
    if (related && role_of(entry.path()) == role) candidates.push_back(entry.path());
  }
  std::sort(candidates.begin(), candidates.end());
  return candidates.empty() ? fs::path{} : candidates.front();
}

// --- Maps ---

// The maps of a texture, decoded but not yet interpreted.
struct SourceMaps {
  DecodedImage normal, height;  // without pixels: none; the height may be the normal map's alpha
  ImportReport report;
};

void take_alpha_as_height(SourceMaps& source) {
  if (source.normal.pixels.empty() || source.normal.pixels.channels != 4 ||
      is_constant(source.normal.pixels, 3))
    return;
  const Pixels& from = source.normal.pixels;
  source.height.pixels = Pixels(from.width, from.height, 1);
  for (std::size_t k = 0; k < source.height.pixels.data.size(); ++k)
    source.height.pixels.data[k] = from.data[4 * k + 3];
  source.height.bit_depth = source.normal.bit_depth;
  source.report.height_channel = 3;
  source.report.height_file = source.report.normal_file;
}

enum class PathKind { image, folder };

Result<SourceMaps> load(const TextureFiles& files, PathKind kind) {
  const bool single = kind == PathKind::image;
  SourceMaps source;
  source.report.colour_file = files.colour;
  if (!files.normal.empty()) {
    auto image = read_image(files.normal);
    if (!image) return tl::unexpected(image.error());
    map_signed_normals_to_unit_range(image->pixels);
    const bool normals = image->pixels.channels >= 3 && looks_like_normals(image->pixels);
    if (!single && image->pixels.channels < 3)
      return fail(files.normal.string(), "is a grey image, but its name says normal map", "rename it");
    if (single && !normals) {
      source.height = std::move(*image);
      source.report.height_file = files.normal;
    } else {
      source.normal = std::move(*image);
      source.report.normal_file = files.normal;
    }
  }
  if (source.height.pixels.empty() && single) take_alpha_as_height(source);
  if (!files.height.empty() && source.height.pixels.empty()) {
    auto image = read_image(files.height);
    if (!image) return tl::unexpected(image.error());
    source.height = std::move(*image);
    source.report.height_file = files.height;
  }
  if (source.height.pixels.empty()) take_alpha_as_height(source);
  source.report.normal_bits = source.normal.pixels.empty() ? 0 : source.normal.bit_depth;
  source.report.height_bits = source.height.pixels.empty() ? 0 : source.height.bit_depth;
  return source;
}

// Quantisation step of a map with this bit depth, as a fraction of its range.
double quantisation_step(int bits) {
  return 1.0 / (std::ldexp(1.0, std::min(bits, 24)) - 1);
}

std::string name_of(const fs::path& path) {
  return path.empty() ? "the recipe" : path.filename().string();
}

// Interprets the maps of one texture.
class Importer {
 public:
  // Frees each map as soon as it is read: pixels are larger than what is kept of them.
  Importer(SourceMaps source, const ImportOptions& options)
      : options_(options),
        has_normals_(!source.normal.pixels.empty()),
        has_height_(!source.height.pixels.empty()) {
    out_.report = std::move(source.report);
    if (has_normals()) {
      MapSlopes read = read_slopes(source.normal.pixels);
      slopes_ = std::move(read.slopes);
      out_.report.clamped_normals = read.clamped;
    }
    source.normal.pixels = {};
    if (has_height()) height_ = read_height(source.height.pixels, 0);
  }

  Imported run() {
    if (has_height()) {
      if (stretch_to_unit_range(height_)) note("height values outside 0..1 were rescaled to 0..1");
      if (has_normals() && (height_.width != slopes_.x.width || height_.height != slopes_.x.height))
        resample_height();
    }
    const Field& size = has_normals() ? slopes_.x : height_;
    out_.texels.width = size.width;
    out_.texels.height = size.height;
    apply_conventions();
    choose_depth();
    if (options_.mode == ImportMode::fused && has_normals()) {
      fuse_maps();
    } else {
      keep_maps();
    }
    return std::move(out_);
  }

 private:
  bool has_normals() const { return has_normals_; }
  bool has_height() const { return has_height_; }
  void note(std::string line) { out_.notes.push_back(std::move(line)); }
  void warn(std::string line) { out_.warnings.push_back(std::move(line)); }

  void resample_height() {
    note(fmt::format("height of {} x {} resampled to the normal map's {} x {}", height_.width, height_.height,
                     slopes_.x.width, slopes_.x.height));
    height_ = resample(height_, slopes_.x.width, slopes_.x.height);
  }

  // Green sign, polarity and row order; afterwards slopes_ are +Y and height_ is white = high.
  void apply_conventions() {
    ImportReport& report = out_.report;
    Green green = has_normals() && name_says_directx(report.normal_file) ? Green::minus_y : Green::plus_y;
    Polarity polarity = report.height_channel == 3 ? Polarity::depth : Polarity::height;
    if (has_normals() && has_height()) {
      const Detection found = detect_conventions(slopes_, height_);
      report.correlation = found.correlation;
      report.correlation_u = found.correlation_u;
      report.correlation_v = found.correlation_v;
      agrees_ = found.agrees();
      if (agrees_) {
        report.detected_green = green = found.green;
        report.detected_polarity = polarity = found.polarity;
        report.rows_flipped = found.rows_flipped;
        report.implied_depth = found.implied_depth;
      } else {
        warn(fmt::format(
            "normals and height barely agree (correlation {:.2f}): do they describe the same surface?",
            found.correlation));
      }
    }
    report.green = green = options_.green.value_or(green);
    report.polarity = polarity = options_.polarity.value_or(polarity);
    if (options_.flip_height_rows.value_or(report.rows_flipped)) flip_rows(height_);
    if (has_normals()) {
      if (green == Green::minus_y) negate(slopes_.y);
      note(fmt::format("normals from {}, green {}", name_of(report.normal_file),
                       green == Green::plus_y ? "+Y" : "-Y"));
    }
    if (has_height()) {
      if (polarity == Polarity::depth) invert(height_);
      note(fmt::format("{} from {}{}{}",
                       polarity == Polarity::height ? "height (white = high)" : "depth (white = deep)",
                       name_of(report.height_file), report.height_channel == 3 ? ", alpha channel" : "",
                       report.rows_flipped ? ", rows flipped" : ""));
    }
    if (agrees_)
      note(fmt::format("correlation of normals and height {:.2f}; implied full depth {:.2f} % of the side",
                       report.correlation, 100 * report.implied_depth));
  }

  // Chooses the full depth. A requested depth rescales the normals' slopes.
  void choose_depth() {
    const double implied = agrees_ ? out_.report.implied_depth : 0;
    out_.depth_fraction = options_.depth_fraction.value_or(implied > 0 ? implied : default_depth_fraction);
    if (options_.mode == ImportMode::fused && agrees_ && options_.depth_fraction && implied > 0)
      scale(slopes_, out_.depth_fraction / implied);
  }

  void fuse_maps() {
    FuseInput input;
    const double texels = out_.depth_fraction * slopes_.x.width;  // full depth
    const bool both = has_height() && agrees_;
    if (has_height() && !agrees_) {
      warn("using the height only; normals come from its slopes");
      return keep_height();
    }
    if (both) {
      input.height = std::move(height_);
      scale(input.height, texels);
      input.height_step = texels * quantisation_step(out_.report.height_bits);
    }
    input.slopes = std::move(slopes_);
    input.normal_step = 2 * quantisation_step(out_.report.normal_bits);
    input.edge = options_.edge == Edge::wrap ? FuseEdge::periodic : FuseEdge::mirrored;
    Fused fused = fuse(std::move(input));
    out_.report.curl = fused.curl;
    out_.report.lambda = fused.lambda;
    out_.report.mean_slope_u = fused.mean_slope_x;
    out_.report.mean_slope_v = fused.mean_slope_y;
    if (!both)
      note(fmt::format("height integrated from the normals; {:.0f} % of their slope is not integrable",
                       100 * fused.curl));
    const double tilt = std::hypot(fused.mean_slope_x, fused.mean_slope_y);
    if (!both && options_.edge == Edge::wrap && tilt > 0.05)
      warn(fmt::format(
          "the normals have a mean tilt of {:.1f} degrees; removed, because a repeating tile cannot tilt",
          std::atan(tilt) * 180 / std::numbers::pi));
    out_.texels.normal = normals_of(fused.slopes);
    fused.slopes = {};
    set_depth(fused.height, both ? texels : 0);
  }

  // Stores `height` (texels) as depth in fractions of its range, 0 at the top. `top` is the top of the height
  // map, 0 without one: it stays the zero of the depth unless the fused height rises above it.
  void set_depth(const Field& height, double top) {
    const auto [low, high] = std::minmax_element(height.value.begin(), height.value.end());
    const double highest = std::max(top, double(*high));
    const double ceiling = top > 0 ? highest : double(*high);
    const double range = std::max(1e-9, ceiling - double(*low));
    out_.texels.depth.resize(height.value.size());
    std::transform(height.value.begin(), height.value.end(), out_.texels.depth.begin(),
                   [&](float h) { return float((ceiling - double(h)) / range); });
    if (!(has_height() && agrees_) && options_.depth_fraction) {
      // An implied height scaled to the requested depth.
      const double factor = options_.depth_fraction.value() * height.width / range;
      rescale_normals(out_.texels.normal, factor);
      return;
    }
    out_.depth_fraction = range / height.width;
  }

  void keep_depth() {
    invert(height_);
    out_.texels.depth = std::move(height_.value);
  }

  void keep_height() {
    out_.texels.normal = normals_of(central_slopes(height_, out_.depth_fraction));
    keep_depth();
  }

  void keep_maps() {
    if (has_normals()) {
      out_.texels.normal = normals_of(slopes_);
      if (has_height()) keep_depth();
    } else {
      note("normals from the slopes of the height");
      keep_height();
    }
  }

  ImportOptions options_;
  bool has_normals_, has_height_;
  Slopes slopes_;
  Field height_;
  bool agrees_ = false;
  Imported out_;
};

// A generated texture goes through the same detection as files, but is not fused: its normals match its
// depth.
Imported import_recipe(const Recipe& recipe, ImportOptions options) {
  const TextureImages images = make_texture(recipe, options.generated_size);
  SourceMaps source;
  source.report.generated = true;
  source.report.normal_bits = source.report.height_bits = source.normal.bit_depth = 16;
  source.normal.pixels = to_unit_range(images.relief);
  take_alpha_as_height(source);
  if (!options.depth_fraction) options.depth_fraction = recipe.about.depth_fraction;
  options.mode = ImportMode::raw;
  Imported imported = Importer(std::move(source), options).run();
  imported.texels.colour = read_colour(to_unit_range(images.colour));
  imported.notes.push_back(fmt::format("generated from recipe {}", recipe.about.name));
  return imported;
}

// --- Output ---

Image16 relief_image(const Texels& texels) {
  const bool depth = !texels.depth.empty();
  Image16 image(texels.width, texels.height, depth ? 4 : 3);
  for (int y = 0; y < texels.height; ++y) {
    for (int x = 0; x < texels.width; ++x) {
      const std::size_t k = std::size_t(texels.height - 1 - y) * std::size_t(texels.width) + std::size_t(x);
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = encode_component(texels.normal[k][c]);
      if (depth)
        image.at(x, y, 3) = std::uint16_t(std::lround(std::clamp(double(texels.depth[k]), 0.0, 1.0) * 65535));
    }
  }
  return image;
}

Image8 colour_image(const Image8& colour) {
  Image8 image(colour.width, colour.height, 3);
  for (int y = 0; y < colour.height; ++y) {
    for (int x = 0; x < colour.width; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = colour.at(x, colour.height - 1 - y, c);
    }
  }
  return image;
}

}  // namespace

double TextureExtent::import_bytes(const ImportOptions& options) const {
  // While the maps are fused: four spectra of 8 bytes (fuse.cpp), of a tile four times as large where it does
  // not repeat, and 12 of fields. While the colour is read: 28 of texels, and its own floats and bytes.
  const bool mirrored = options.mode == ImportMode::fused && options.edge == Edge::clamp;
  return std::max((mirrored ? 130 : 38) * texels, 28 * texels + 19 * coloured);
}

double TextureExtent::surface_bytes() const {
  return 12 * texels + 3 * coloured;
}

TextureExtent texture_extent(const fs::path& path, int generated_size) {
  const double generated = double(generated_size) * generated_size;
  if (const auto recipe = find_recipe(path.string()); !recipe || *recipe) return {generated, generated};
  const auto files = find_texture_files(path);
  if (!files) return {};
  const auto pixels = [](const fs::path& file) {
    return file.empty() ? 0.0 : double(read_image_size(file).pixels());
  };
  // A height is resampled to its normals' size.
  return {files->normal.empty() ? pixels(files->height) : pixels(files->normal), pixels(files->colour)};
}

Result<Imported> import_texture(const fs::path& path, const ImportOptions& options) {
  const MemoryCost cost("texture", texture_extent(path, options.generated_size).import_bytes(options));
  if (auto fits = check_memory(path.string(), cost, options.allowed_memory); !fits)
    return tl::unexpected(fits.error());
  const auto recipe = find_recipe(path.string());
  if (!recipe) return tl::unexpected(recipe.error());
  if (*recipe) {
    if (auto size = check_texture_size(options.generated_size, path.string()); !size)
      return tl::unexpected(size.error());
    return import_recipe(**recipe, options);
  }
  std::error_code error;
  const auto files = find_texture_files(path);
  if (!files) return tl::unexpected(files.error());
  auto source = load(*files, fs::is_directory(path, error) ? PathKind::folder : PathKind::image);
  if (!source) return tl::unexpected(source.error());
  Imported imported = Importer(std::move(*source), options).run();
  imported.texels.colour = default_colour();
  if (files->colour.empty()) {
    imported.notes.push_back("no colour map found: plain grey");
  } else {
    const auto colour = read_image(files->colour);
    if (!colour) return tl::unexpected(colour.error());
    imported.texels.colour = read_colour(colour->pixels);
    imported.notes.push_back("colour from " + name_of(files->colour));
  }
  return imported;
}

bool name_says_directx(const fs::path& path) {
  return role_of(path) == Role::normal_dx;
}

Result<TextureFiles> find_texture_files(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return search_folder(path);
  return TextureFiles{path, companion_file(path, Role::height), companion_file(path, Role::colour)};
}

Result<void> write_texture_files(const Imported& imported, const std::filesystem::path& folder) {
  OutputFiles files;
  if (auto written = files.write(folder / "relief.png", encode_png(relief_image(imported.texels))); !written)
    return written;
  if (auto written = files.write(folder / "color.png", encode_png(colour_image(imported.texels.colour)));
      !written)
    return written;
  return files.commit();
}

}  // namespace intaglio::surface
