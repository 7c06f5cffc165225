#include "intaglio/haptics/devices/vrpn/framer.h"

namespace intaglio::haptics::vrpn {

void Framer::feed(View bytes) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(used_));
  used_ = 0;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

std::optional<Message> Framer::next() {
  for (;;) {
    const Taken taken = take_message(rest());
    if (taken.frame == Frame::partial) return std::nullopt;
    used_ += taken.size;
    if (taken.frame == Frame::whole) return taken.message;
    ++bad_frames_;
  }
}

View Framer::take(std::size_t size) {
  if (waiting() < size) return {};
  const View taken = rest().first(size);
  used_ += size;
  return taken;
}

}  // namespace intaglio::haptics::vrpn
