// A design with the files that it names, and the check that each of its trials makes a scene.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <system_error>

#include "core/file.h"
#include "core/text.h"
#include "study/design/design.h"
#include "study/design/plan.h"
#include "study/store/sha256.h"

namespace intaglio::study {

namespace {

constexpr std::uintmax_t most_bytes = 1u << 20, most_picture_bytes = 64u << 20;

// The file in the working folder, otherwise beside the design.
std::filesystem::path find_file(const std::string& file, const std::filesystem::path& design) {
  std::error_code ignored;
  const auto beside = design.parent_path() / file;
  return std::filesystem::exists(file, ignored) || !std::filesystem::exists(beside, ignored)
             ? std::filesystem::path(file)
             : beside;
}

class FileReader {
 public:
  FileReader(const std::filesystem::path& path, Design& design) : path_(path), design_(design) {}

  Result<std::string> read(const std::string& file, std::uintmax_t limit) {
    const auto found = find_file(file, path_);
    // Fuzzed by fuzz/design.cpp through parse_design
    const auto bytes = read_text(found, limit);
    if (!bytes) return tl::unexpected(with_where(path_.string(), bytes.error()));
    if (seen_.insert(file).second) design_.files.push_back({file, sha256(*bytes)});
    return *bytes;
  }

 private:
  const std::filesystem::path& path_;
  Design& design_;
  std::set<std::string> seen_;
};

Result<void> read_scenes(FileReader& reader, Design& design) {
  const auto put = [&](const std::string& file, std::string& text) -> Result<void> {
    if (file.empty()) return {};
    auto read = reader.read(file, most_bytes);
    if (!read) return tl::unexpected(read.error());
    text = std::move(*read);
    return {};
  };
  if (auto done = put(design.scene, design.scene_text); !done) return done;
  for (StepDesign& step : design.steps) {
    if (auto done = put(step.scene, step.scene_text); !done) return done;
    for (const std::string& picture : step.pictures)
      if (auto read = reader.read(picture, most_picture_bytes); !read)
        return tl::unexpected(with_where(step.line, read.error()));
  }
  return {};
}

// Recipes of textures that lie beside the design are a part of it.
Result<void> read_recipes(FileReader& reader, const std::filesystem::path& path, Design& design) {
  std::set<std::string> recipes;
  const auto add = [&](const Overrides& set) {
    for (const auto& [key, value] : set.values())
      if (key.ends_with("texture") && value.ends_with(".toml\""))
        recipes.insert(value.substr(1, value.size() - 2));
  };
  add(design.set);
  for (const StudyMaterial& material : design.materials) add(material.set);
  for (const Factor& factor : design.factors)
    for (const Level& level : factor.levels) add(level.set);
  for (const StepDesign& step : design.steps) add(step.set);
  std::error_code ignored;
  for (const std::string& recipe : recipes)
    if (std::filesystem::exists(find_file(recipe, path), ignored))
      if (auto read = reader.read(recipe, most_bytes); !read) return tl::unexpected(read.error());
  return {};
}

}  // namespace

Result<void> check_scenes(const Design& design) {
  std::set<std::string> checked;
  // Enough participants that each has met each material at each level, as squares and splits go.
  const int participants = std::clamp(int(2 * design.materials.size()), 2, 24);
  for (int participant = 1; participant <= participants; ++participant) {
    const auto made = plan(design, participant);
    if (!made) return tl::unexpected(made.error());
    for (const PlannedStep& step : made->steps) {
      for (std::size_t k = 0; k < step.items.size(); ++k) {
        const StepDesign& from = design.steps[step.step];
        if (!checked.insert(step.name + "\n" + step.items[k].set.text()).second || checked.size() > 4096)
          continue;
        for (const double amount :
             {from.adaptive ? from.adaptive->low : 0, from.adaptive ? from.adaptive->high : 0}) {
          const auto scene = scene_of(design, step, k, from.adaptive ? std::optional(amount) : std::nullopt,
                                      step.shown.empty() ? std::string() : step.shown.front());
          if (!scene) return fail(from.line, "its scene: " + scene.error().what, scene.error().fix);
        }
      }
    }
  }
  return {};
}

Result<Design> read_design(const std::filesystem::path& path) {
  const auto text = read_text(path, most_bytes);
  if (!text) return tl::unexpected(text.error());
  auto design = parse_design(*text, path.string());
  if (!design) return design;
  FileReader reader(path, *design);
  for (const auto& [language, file] : design->language_files) {
    const auto texts = reader.read(file, most_bytes);
    if (!texts) return tl::unexpected(texts.error());
    if (auto added = parse_texts(*texts, find_file(file, path).string(), language, *design); !added)
      return tl::unexpected(added.error());
  }
  if (auto read = read_scenes(reader, *design); !read) return tl::unexpected(read.error());
  if (auto read = read_recipes(reader, path, *design); !read) return tl::unexpected(read.error());
  if (auto checked = check_scenes(*design); !checked) return tl::unexpected(checked.error());
  // Names as the design gives them, so that its place does not matter.
  std::string all = design->files[0].sha256 + "\n";
  for (std::size_t k = 1; k < design->files.size(); ++k)
    all += design->files[k].name + " " + design->files[k].sha256 + "\n";
  design->hash = sha256(all);
  return design;
}

}  // namespace intaglio::study
