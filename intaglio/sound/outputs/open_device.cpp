#include "intaglio/sound/outputs/open_device.h"

#include "intaglio/sound/outputs/null_device.h"
#include "intaglio/sound/outputs/rtaudio_device.h"

namespace intaglio::sound {

Result<OpenedDevice> open_audio_device(const AudioRequest& request) {
  if (request.sample_rate < 8000 || request.sample_rate > 192'000)
    return fail("sound", fmt::format("a sample rate of {} Hz", request.sample_rate), "44100 is usual");
  if (request.buffer_frames < 16 || request.buffer_frames > 8192)
    return fail("sound", fmt::format("a buffer of {} frames", request.buffer_frames), "give 16 to 8192");
  const auto null = [&] { return std::make_unique<NullDevice>(request.sample_rate, request.buffer_frames); };
  if (request.device == "null") return OpenedDevice{null(), ""};
  const bool is_default = request.device == "default";
  auto card = open_sound_card(is_default ? "" : request.device, request.sample_rate, request.buffer_frames);
  if (card) return OpenedDevice{std::move(*card), ""};
  if (!is_default) return tl::unexpected(card.error());
  return OpenedDevice{null(), card.error().what + "; playing to the null device"};
}

}  // namespace intaglio::sound
