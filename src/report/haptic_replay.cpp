#include "report/haptic_replay.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/file.h"
#include "haptics/haptic_log.h"
#include "report/html.h"
#include "report/report.h"
#include "session/scene_loop.h"

namespace intaglio::report {

Result<haptics::HapticLog> read_haptic_log(const std::filesystem::path& path) {
  const auto bytes = read_file(path, 1u << 30);
  if (!bytes) return tl::unexpected(bytes.error());
  auto log =
      haptics::decode_log({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, path.string());
  if (log && log->samples.empty()) return fail(path.string(), "the log has no ticks");
  return log;
}

std::string haptic_summary(const haptics::HapticLog& log) {
  std::size_t touching = 0, faults = 0, warm = 0;
  double most = 0;
  for (const haptics::ServoSample& s : log.samples) {
    touching += s.touching || s.touching_ball;
    faults += (s.guard_status & haptics::guard_status::fault) != 0;
    warm += (s.guard_status & haptics::guard_status::thermally_limited) != 0;
    most = std::max(most, s.force.norm());
  }
  const auto seconds = [&](std::size_t ticks) { return double(ticks) / log.rate; };
  return fmt::format(
      "{:.1f} s at {:.0f} Hz on \"{}\"\n  touching for {:.2f} s, at most {:.2f} N\n  guard: in fault for {:.2f} s, held "
      "to the continuous force for {:.2f} s\n",
      seconds(log.samples.size()), log.rate, log.texture, seconds(touching), most, seconds(faults),
      seconds(warm));
}

std::string haptic_page(const haptics::HapticLog& log, const std::string& title) {
  session::Run run;
  run.duration = double(log.samples.size()) / log.rate;
  run.servo_rate = int(log.rate);
  run.pen = 1;
  Digest digest(run);
  for (const haptics::ServoSample& sample : log.samples) digest.on_tick(sample);
  return page_head(title, report_css) +
         fmt::format("<h1>{}</h1>\n<section>\n<h2>Felt</h2>\n{}</section>\n", escape_html(title),
                     felt_html(digest)) +
         std::string(page_end);
}

Result<Replayed> replay(const haptics::HapticLog& log, const scene::Scene& scene) {
  if (!scene.pen) return fail(scene.name, "the scene has no pen", "add a [pen] table");
  if (scene.pen->device.rate != log.rate) {
    return fail(scene.name,
                fmt::format("its servo rate is {} Hz, the log's {} Hz", scene.pen->device.rate, log.rate),
                "set pen.device_rate to the log's");
  }
  const auto made = scene::make_surface(scene);
  if (!made) return tl::unexpected(made.error());
  haptics::PenServo servo = session::PenLink(scene, *made, scene.surface.representation).make_servo();
  haptics::ReplayDevice device(log.samples);
  haptics::SceneSnapshot at_rest;
  for (std::size_t tick = 0; !device.at_end(); ++tick) {
    at_rest.time = double(tick) / log.rate;
    servo.tick(device, at_rest, at_rest.time);
  }
  return Replayed{device.largest_difference(),
                  haptics::fingerprint(*scene::given(*made, scene::Cue::touch).surface) == log.surface};
}

}  // namespace intaglio::report
