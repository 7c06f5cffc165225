// Captured sessions of VRPN programs, for tests.
#pragma once

#include <fstream>
#include <string>

#include "haptics/vrpn/message.h"
#include "tests/source_folder.h"

namespace intaglio::haptics::vrpn {

struct Chunk {
  std::string from, channel;
  Bytes bytes;
};

// The value of a key in one line of our captures: no value of theirs holds a quote or an escape.
inline std::string value_of(const std::string& line, const std::string& key) {
  const std::size_t at = line.find("\"" + key + "\": \"");
  if (at == std::string::npos) return {};
  const std::size_t start = at + key.size() + 5;
  return line.substr(start, line.find('"', start) - start);
}

// Empty where the captures, which are kept outside the project, are absent.
inline std::vector<Chunk> read_capture(const std::string& name) {
  std::ifstream file(std::string(tests::shared_folder) + "/vrpn/captures/" + name);
  std::vector<Chunk> chunks;
  for (std::string line; std::getline(file, line);) {
    Chunk chunk{value_of(line, "from"), value_of(line, "channel"), {}};
    const std::string hex = value_of(line, "hex");
    for (std::size_t k = 0; k + 1 < hex.size(); k += 2)
      chunk.bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(k, 2), nullptr, 16)));
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

// All that one side sent by TCP.
inline Bytes stream_of(const std::string& capture, std::string_view side) {
  Bytes stream;
  for (const Chunk& chunk : read_capture(capture))
    if (chunk.from == side && chunk.channel == "tcp")
      stream.insert(stream.end(), chunk.bytes.begin(), chunk.bytes.end());
  return stream;
}

}  // namespace intaglio::haptics::vrpn
