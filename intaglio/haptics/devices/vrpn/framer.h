// A stream of bytes, however the network cuts it, into messages.
//
// A frame whose length cannot be believed costs its 24 bytes of header and counts as bad; what follows is
// tried as a frame again, and when the stream has lost its step three bad frames come soon and the peer is
// dropped. Holds at most one message and what one read brings. One thread.
#pragma once

#include <optional>

#include "intaglio/haptics/devices/vrpn/message.h"

namespace intaglio::haptics::vrpn {

class Framer {
 public:
  // Appends bytes as they were read. Invalidates messages taken before.
  void feed(View bytes);
  // The next whole message, valid until the next feed(); none when more bytes are needed.
  std::optional<Message> next();
  // The first `size` bytes as they are (the cookie); empty when there are fewer.
  View take(std::size_t size);

  int bad_frames() const { return bad_frames_; }
  // Bytes of a message that is not whole yet.
  std::size_t waiting() const { return buffer_.size() - used_; }

 private:
  View rest() const { return View(buffer_).subspan(used_); }

  Bytes buffer_;
  std::size_t used_ = 0;
  int bad_frames_ = 0;
};

}  // namespace intaglio::haptics::vrpn
