#include "scene/scene.h"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <limits>

#include "core/file.h"
#include "core/toml.h"
#include "intaglio/representation.h"
#include "scene/scene_reader.h"
#include "scene/scene_table.h"

namespace intaglio::scene {

namespace {

void read_surface(TomlReader& r, SurfaceSettings& surface) {
  read_texture(r, surface);
  r.vec2("size", surface.size, {0.01, 100, false, "a side must be between 0.01 m and 100 m"});
  r.number("thickness", surface.thickness,
           {0.001, 10, false, "a thickness must be between 0.001 m and 10 m"});
  r.vec3("position", surface.position);
  r.vec3("rotation", surface.rotation);
  if (r.has("material")) {
    read_material(r, "material", surface.material.emplace(*find_material("brick")));
  } else {
    r.optional_key("material");
  }
}

void read_representation(TomlReader& r, SurfaceSettings& floor) {
  r.choice("representation", {"flat", "normal", "relief"}, floor.representation);
}

void read_physics(TomlReader& r, PhysicsSettings& physics) {
  r.integer("rate", physics.rate, {30, 20000, false, "a rate must be between 30 Hz and 20000 Hz"});
  r.vec3("gravity", physics.gravity);
  r.choice("contact", {"closest", "directional"}, physics.method);
  r.choice("normals", {"implied", "literal"}, physics.normal_method);
  r.number("respawn_below", physics.respawn_below,
           {-1e4, 1e4, false, "a height must be between -10000 m and 10000 m"});
}

void read_path(TomlReader& r, PenSettings& pen) {
  std::vector<std::vector<double>> rows;
  r.rows("path", 4, rows);
  for (const auto& row : rows) {
    if (!pen.path.empty() && row[0] <= pen.path.back().time) {
      r.fail_at("path", fmt::format("pen.path: time {} s does not increase", row[0]),
                "times must increase from row to row");
    }
    if (row[0] < 0 || row[0] > 1e5)
      r.fail_at("path", fmt::format("pen.path: time {:g} s is out of range", row[0]),
                "times must be between 0 s and 100000 s");
    for (std::size_t k = 1; k < 4; ++k) {
      if (std::abs(row[k]) > 1e4)
        r.fail_at("path", fmt::format("pen.path: coordinate {:g} m is out of range", row[k]),
                  "each number must be between -10000 and 10000");
    }
    pen.path.push_back({row[0], {row[1], row[2], row[3]}});
  }
  if (pen.path.empty()) r.fail_at("path", "pen.path has no waypoint", "give rows of [time s, x m, y m, z m]");
}

void read_pen(TomlReader& r, PenSettings& pen) {
  r.number("length", pen.length, positive("a length must be greater than 0 m and at most 10 m", 10));
  r.number("radius", pen.radius, positive("a radius must be greater than 0 m and at most 1 m", 1));
  read_material(r, "material", pen.material);
  read_direction(r, "direction", pen.direction);
  r.vec3("workspace_origin", pen.workspace.origin);
  r.number("workspace_scale", pen.workspace.scale,
           positive("a scale must be greater than 0 and at most 1000", 1e3));
  r.choice("method", {"potential", "plane"}, pen.method);
  r.number("tip_radius", pen.tip_radius, at_least_zero("a tip radius must be between 0 m and 1 m", 1));
  r.number("stiffness", pen.spring.stiffness, at_least_zero("stiffness must be between 0 and 1e5 N/m", 1e5));
  r.number("damping", pen.spring.damping, at_least_zero("damping must be between 0 and 1e3 N s/m", 1e3));
  int rate = int(pen.device.rate);
  r.integer("device_rate", rate, {100, 20000, false, "a servo rate must be between 100 Hz and 20000 Hz"});
  pen.device.rate = rate;
  r.number("device_peak_force", pen.device.peak_force,
           positive("a peak force must be greater than 0 N and at most 100 N", 100));
  r.number("device_resolution", pen.device.resolution,
           positive("a resolution must be greater than 0 m and at most 0.01 m", 0.01));
  r.vec3("device_workspace", pen.device.workspace);
  if (pen.device.workspace.minCoeff() < 0.001 || pen.device.workspace.maxCoeff() > 10)
    r.fail_at("device_workspace", "a side of the device's workspace is out of range",
              "sides must be between 0.001 m and 10 m");
  r.number("ramp_in", pen.limits.ramp_in,
           {0.5, 60, false, "ramp_in must be between 0.5 s and 60 s (a safety limit)"});
  r.number("hand_mass", pen.hand.mass, positive("a mass must be greater than 0 kg and at most 100 kg", 100));
  r.number("hand_stiffness", pen.hand.stiffness,
           positive("stiffness must be greater than 0 N/m and at most 1e5 N/m", 1e5));
  r.number("hand_damping", pen.hand.damping, at_least_zero("damping must be between 0 and 1e4 N s/m", 1e4));
  read_path(r, pen);
  pen.limits.peak_force = pen.device.peak_force;
}

void read_sound(TomlReader& r, SoundSettings& sound) {
  r.integer("sample_rate", sound.sample_rate,
            {8000, 192000, false, "a sample rate must be between 8000 Hz and 192000 Hz"});
  r.number("gain_db", sound.gain_db, {-120, 60, false, "a gain must be between -120 dB and 60 dB"});
  r.choice("meso", {"engine", "texels", "height"}, sound.meso);
  r.number("micro", sound.micro, at_least_zero("a level must be between 0 and 100", 100));
  r.integer("modes", sound.modes, {1, 2000, false, "between 1 and 2000 modes a body"});
}

void read_video(TomlReader& r, VideoSettings& video) {
  r.integer("width", video.width, {16, 7680, false, "a width must be between 16 and 7680 pixels"});
  r.integer("height", video.height, {16, 4320, false, "a height must be between 16 and 4320 pixels"});
  r.integer("fps", video.fps, {1, 240, false, "between 1 and 240 frames a second"});
  r.integer("supersample", video.supersample, {1, 4, false, "supersampling must be between 1 and 4"});
  if (video.width % 2 != 0 || video.height % 2 != 0)
    r.fail_at(video.width % 2 != 0 ? "width" : "height", "video.width and video.height must be even",
              "H.264 needs even sizes");
}

void read_camera(TomlReader& r, CameraSettings& camera) {
  r.vec3("eye", camera.eye);
  r.vec3("target", camera.target);
  r.number("vertical_fov", camera.vertical_fov,
           {1, 170, false, "a field of view must be between 1 and 170 degrees"});
  if ((camera.target - camera.eye).norm() < 1e-6)
    r.fail_at(r.has("eye") ? "eye" : "target", "the camera's eye and target coincide",
              "camera.eye and camera.target must be different points");
}

// touch = false, or a table of settings.
void read_cue(TomlReader& cues, const char* name, CueSettings& cue) {
  if (!cues.is_table(name)) return cues.boolean(name, cue.on);
  cues.table(name, [&](TomlReader& r) {
    r.boolean("on", cue.on);
    r.number("delay", cue.delay,
             {0, max_cue_delay, false,
              "a delay must be between 0 s and 1 s; no sense can be early, but the others can be late"});
    r.vec2("shift", cue.shift,
           {-max_cue_shift, max_cue_shift, false, "a shift along u or v must be between -1 m and 1 m"});
    if (r.has("texture")) {
      r.string("texture", cue.texture.emplace());
      cue.line = r.line_of("texture");
    } else {
      r.optional_key("texture");
    }
  });
}

}  // namespace

void put_texture(SurfaceSettings& surface, const std::string& texture) {
  surface.texture = texture;
  surface.depth.reset();
  surface.green.reset();
  surface.polarity.reset();
  surface.line.clear();
}

Result<Scene> scene_of_table(const toml::table& table, const std::string& name) {
  std::optional<Error> error;
  Scene scene;
  scene.name = name;
  TomlReader r(table, name, "", error);
  r.string("title", scene.title);
  r.number("duration", scene.duration, {0.1, 3600, false, "a duration must be between 0.1 s and 3600 s"});
  r.integer("seed", scene.seed, at_least_zero("a seed must be an integer from 0 to 1e9", 1e9));
  read_direction(r, "light", scene.light);
  r.table("surface", [&](TomlReader& t) {
    read_surface(t, scene.surface);
    read_representation(t, scene.surface);
  });
  r.table("physics", [&](TomlReader& t) { read_physics(t, scene.physics); });
  r.tables("ground", [&](TomlReader& t) {
    read_surface(t, scene.grounds.emplace_back());
    read_base(t, scene.grounds.back());
    t.optional_key("representation");
    t.only_keys("a ground (representation is set on the floor, in [surface])", {}, {"representation"});
    scene.grounds.back().representation = scene.surface.representation;
  });
  r.tables("ball", [&](TomlReader& t) { read_ball(t, scene.surface, scene.balls); });
  r.tables("body", [&](TomlReader& t) { read_body(t, scene.surface, scene.bodies); });
  r.table("pen", [&](TomlReader& t) { read_pen(t, scene.pen.emplace()); });
  r.table("sound", [&](TomlReader& t) { read_sound(t, scene.sound); });
  r.table("video", [&](TomlReader& t) { read_video(t, scene.video); });
  r.table("camera", [&](TomlReader& t) { read_camera(t, scene.camera); });
  r.table("cues", [&](TomlReader& t) {
    for (const Cue cue : all_cues) read_cue(t, name_of(cue), scene.cues[cue]);
  });
  r.finish();
  if (error) return tl::unexpected(*error);
  return scene;
}

Result<Scene> parse_scene(std::string_view text, const std::string& name) {
  const auto parsed = parse_toml(text, name);
  if (!parsed) return tl::unexpected(parsed.error());
  return scene_of_table(*parsed, name);
}

void find_files_beside(Scene& scene, const std::filesystem::path& folder) {
  const auto find = [&](std::string& file) {
    std::error_code ignored;
    const auto beside = folder / file;
    if (!std::filesystem::exists(file, ignored) && std::filesystem::exists(beside, ignored))
      file = beside.string();
  };
  find(scene.surface.texture);
  for (SurfaceSettings& ground : scene.grounds) {
    find(ground.texture);
    if (ground.base && !ground.base->file.empty()) find(ground.base->file);
  }
  for (BodySettings& body : scene.bodies)
    for (SurfaceSettings& relief : body.reliefs) find(relief.texture);
  for (const Cue cue : all_cues)
    if (auto& texture = scene.cues[cue].texture) find(*texture);
}

Result<Scene> read_scene(const std::filesystem::path& path, std::uint64_t allowed_memory) {
  const auto bytes = read_file(path, 16u << 20);
  if (!bytes) return tl::unexpected(bytes.error());
  auto scene = parse_scene({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, path.string());
  if (!scene) return scene;
  scene->allowed_memory = allowed_memory;
  find_files_beside(*scene, path.parent_path());
  return scene;
}

}  // namespace intaglio::scene
