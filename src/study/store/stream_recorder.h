// Writes high-rate streams while a trial runs: real-time threads push records into lock-free queues, and one
// other thread appends them to files (study/store/stream_file.h) every 20 ms, so that a process that is
// killed has lost less than the last 100 ms.
//
// Where writing fails (a full disk), what is pending is tried again with each flush, up to 8 MB a stream; the
// records beyond are counted as dropped, and error() says why.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "core/lock_free.h"
#include "intaglio/error.h"
#include "study/store/stream_file.h"

namespace intaglio::study {

class Stream {
 public:
  // One thread, real-time: neither locks nor allocates. `values` has one number for each column. False: there
  // was no room, and the record is counted as dropped.
  bool push(std::span<const double> values);
  const StreamHeader& header() const { return header_; }

 private:
  friend class StreamRecorder;
  using Record = std::array<double, max_stream_columns>;

  Stream(StreamHeader header, std::filesystem::path path, int descriptor);
  void take();   // from the queue to what is pending
  void write();  // what is pending to the file

  StreamHeader header_;
  std::filesystem::path path_;
  int descriptor_;
  std::uint32_t frames_ = 0;
  std::int64_t offset_ = 0;  // bytes of whole frames in the file
  std::string pending_;      // whole frames
  SpscQueue<Record> queue_{8192};
  std::atomic<std::uint64_t> dropped_{0};
  std::uint64_t written_drops_ = 0, records_ = 0;
  std::optional<Error> error_;
};

struct StreamEnd {
  std::uint64_t records = 0, dropped = 0;
};

class StreamRecorder {
 public:
  StreamRecorder();
  ~StreamRecorder();  // writes what is pending; files without an end frame remain readable

  // Creates the file, which must not exist. The stream is valid until it is closed.
  Result<Stream*> open(const std::filesystem::path& path, const StreamHeader& header);
  // After its thread has pushed its last record: all is written and on the disk when this returns.
  Result<StreamEnd> close(Stream* stream);
  // The newest failure to write a stream that is open.
  std::optional<Error> error() const;

 private:
  void run();

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<std::unique_ptr<Stream>> streams_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace intaglio::study
