#include "session/result_files.h"

#include <utility>

namespace intaglio::session {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t pending_samples = 1 << 14;

// The texture that was felt, and what was false beside.
std::string felt_name(const Run& run) {
  const std::string note = scene::cue_note(run.cues);
  return note.empty() ? run.felt_texture : run.felt_texture + " (" + note + ")";
}

}  // namespace

Result<std::unique_ptr<ResultFiles>> ResultFiles::create(OutputFiles& files, const fs::path& output,
                                                         const Run& run) {
  const auto beside = [&](const char* extension) { return fs::path(output).replace_extension(extension); };
  auto wav_file = files.add(beside(".wav"));
  if (!wav_file) return tl::unexpected(wav_file.error());
  auto wav = sound::WavWriter::create(*wav_file, beside(".wav"), run.sample_rate, {.channels = 2});
  if (!wav) return tl::unexpected(wav.error());
  auto events = FileStream::create(files, beside(".events.csv"));
  if (!events) return tl::unexpected(events.error());
  auto servo = FileStream::create(files, beside(".servo.csv"));
  if (!servo) return tl::unexpected(servo.error());
  return std::unique_ptr<ResultFiles>(
      new ResultFiles(std::move(*wav_file), std::move(*wav), std::move(*events), std::move(*servo), run));
}

ResultFiles::ResultFiles(fs::path wav_file, sound::WavWriter wav, FileStream events, FileStream servo,
                         const Run& run)
    : wav_file_(std::move(wav_file)),
      wav_(std::move(wav)),
      events_(std::move(events)),
      servo_(std::move(servo)),
      log_(run.servo_rate, felt_name(run), run.felt_surface ? haptics::fingerprint(*run.felt_surface) : 0,
           [this](std::string_view text) { servo_.write(text); }) {
  if (const std::string note = scene::cue_note(run.cues); !note.empty()) events_.write("# " + note + "\n");
  events_.write(event_columns);
}

void ResultFiles::on_sound(std::span<const float> stereo) {
  pending_.insert(pending_.end(), stereo.begin(), stereo.end());
  if (pending_.size() < pending_samples) return;
  wav_.add(pending_);
  pending_.clear();
}

Result<void> ResultFiles::check() const {
  for (const std::optional<Error>& error : {wav_.error(), events_.error(), servo_.error()})
    if (error) return tl::unexpected(*error);
  return {};
}

Result<void> ResultFiles::finish() {
  wav_.add(pending_);
  log_.finish();
  for (Result<void> finished : {wav_.finish(), events_.finish(), servo_.finish()})
    if (!finished) return finished;
  return {};
}

}  // namespace intaglio::session
