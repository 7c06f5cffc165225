// High-rate streams: each record that was pushed is in the file, a torn tail costs its own frame alone, a
// file of a process that was killed is found and hashed when its store is opened again.
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

#include "core/file.h"
#include "study/store/sha256.h"
#include "study/store/store.h"
#include "tests/study/example_study.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::study;
using namespace intaglio::tests;

namespace {

StreamHeader pose_header(const std::string& session, std::int64_t step) {
  StreamHeader header;
  header.name = "pose";
  header.session = session;
  header.step = step;
  header.rate_hz = 1000;
  header.columns = {{"time", "s", "LATENCY", "n/a", "n/a"},
                    {"x", "m", "POS", "x", "pen"},
                    {"y", "m", "POS", "y", "pen"},
                    {"z", "m", "POS", "z", "pen"}};
  return header;
}

std::string example_bytes(std::size_t rows, std::size_t rows_a_frame) {
  std::string bytes(stream_magic);
  std::uint32_t number = 0;
  append_frame(bytes, FrameKind::header, number++, header_text(pose_header("5e55", 2)));
  for (std::size_t row = 0; row < rows; row += rows_a_frame) {
    std::vector<double> values;
    for (std::size_t r = row; r < std::min(rows, row + rows_a_frame); ++r)
      for (int c = 0; c < 4; ++c) values.push_back(double(r) + 0.25 * c);
    append_records(bytes, number++, values);
  }
  append_frame(bytes, FrameKind::end, number, {});
  return bytes;
}

}  // namespace

TEST_CASE("CRC-32 of the check string, whole and in pieces") {
  CHECK(crc32("123456789") == 0xcbf43926);
  CHECK(crc32("6789", crc32("12345")) == 0xcbf43926);
}

TEST_CASE("a stream file says what was written") {
  const auto file = parse_stream(example_bytes(100, 7), "a");
  REQUIRE(file);
  CHECK(file->is_complete);
  CHECK(file->rows() == 100);
  CHECK(file->at(99, 3) == 99.75);
  CHECK(file->header == pose_header("5e55", 2));
}

TEST_CASE("a file that is cut anywhere has all whole frames before the cut") {
  const std::string bytes = example_bytes(60, 10);
  const std::size_t head = stream_magic.size() + 20 + header_text(pose_header("5e55", 2)).size();
  const std::size_t frame = 20 + 10 * 4 * sizeof(double);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto file = parse_stream(std::string_view(bytes).substr(0, size), "a");
    CHECK(file.has_value() == (size >= head));
    if (!file) continue;
    CHECK(file->rows() == 10 * std::min<std::size_t>(6, (size - head) / frame));
    CHECK(!file->is_complete);
    CHECK(file->torn_bytes == size - head - std::min<std::size_t>(6, (size - head) / frame) * frame);
  }
}

TEST_CASE("a bit that is flipped anywhere behind the header ends the file there, and is never read") {
  const std::string bytes = example_bytes(60, 10);
  const auto whole = parse_stream(bytes, "a");
  REQUIRE(whole);
  rc::check("no value is wrong", [&] {
    const std::size_t at = *rc::gen::inRange<std::size_t>(0, bytes.size());
    std::string damaged = bytes;
    damaged[at] = char(damaged[at] ^ (1 << *rc::gen::inRange(0, 8)));
    const auto file = parse_stream(damaged, "a");
    if (!file) return;
    RC_ASSERT(!file->is_complete);
    RC_ASSERT(file->values.size() < whole->values.size() || file->torn_bytes > 0);
    for (std::size_t k = 0; k < file->values.size(); ++k) RC_ASSERT(file->values[k] == whole->values[k]);
  });
}

TEST_CASE("a header's columns and names are checked") {
  auto header = pose_header("5e55", 1);
  CHECK(check_header(header));
  header.columns[0].name = "x";
  CHECK(!check_header(header));
  header = pose_header("5e55", 1);
  header.name = "../pose";
  CHECK(!check_header(header));
  header = pose_header("5e55", 1);
  header.columns.resize(17, header.columns[1]);
  CHECK(!check_header(header));
}

TEST_CASE("records that a thread pushes are all in the file, hashed, when the trial has ended") {
  const TemporaryFolder folder;
  auto store = Store::open(folder.path / "a.sqlite", StoreAccess::create);
  REQUIRE(store);
  const std::string session = example_session(*store, "P1", 1, 1);
  REQUIRE(store->begin_step(example_step(session, 1)));
  const auto pose = store->open_stream(pose_header(session, 1));
  REQUIRE(pose);
  auto contacts_header = pose_header(session, 1);
  contacts_header.name = "contacts";
  contacts_header.rate_hz = 0;
  const auto contacts = store->open_stream(contacts_header);
  REQUIRE(contacts);
  std::thread servo([&] {
    for (int k = 0; k < 3000; ++k) {
      const double record[] = {k / 1000.0, k * 1.0, k * 2.0, std::sqrt(double(k))};
      while (!(*pose)->push(record)) std::this_thread::yield();
      if (k % 100 == 0) (*contacts)->push(record);
      if (k % 10 == 0) std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  });
  servo.join();
  REQUIRE(store->finish_step(session, 1, 20, {2, 20, "", ""}));
  const auto rows = store->streams_of(session);
  REQUIRE(rows);
  REQUIRE(rows->size() == 2);
  CHECK((*rows)[1].stream == "pose");
  CHECK((*rows)[1].records == 3000);
  CHECK((*rows)[1].is_complete);
  const auto path = store->streams_folder() / (*rows)[1].file;
  CHECK(hash_file(path)->sha256 == (*rows)[1].sha256);
  const auto file = load_stream(path);
  REQUIRE(file);
  REQUIRE(file->rows() == 3000);
  for (std::size_t k = 0; k < 3000; ++k) REQUIRE(file->at(k, 2) == 2.0 * double(k));
  CHECK(load_stream(store->streams_folder() / (*rows)[0].file)->rows() == 30);
}

TEST_CASE("a queue without room counts what it drops, and the file says so") {
  const TemporaryFolder folder;
  StreamRecorder recorder;
  const auto stream = recorder.open(folder.path / "a.stream", pose_header("5e55", 1));
  REQUIRE(stream);
  const double record[] = {0, 1, 2, 3};
  std::uint64_t pushed = 0, refused = 0;
  for (int k = 0; k < 200000; ++k) ++((*stream)->push(record) ? pushed : refused);
  const auto end = recorder.close(*stream);
  REQUIRE(end);
  CHECK(end->records == pushed);
  CHECK(end->dropped == refused);
  const auto file = load_stream(folder.path / "a.stream");
  REQUIRE(file);
  CHECK(file->rows() == pushed);
  CHECK(file->dropped == refused);
  CHECK(file->is_complete);
}

TEST_CASE("a stream that its process left open is hashed as it is when the store is opened again") {
  const TemporaryFolder folder;
  std::string session;
  {
    auto store = Store::open(folder.path / "a.sqlite", StoreAccess::create);
    REQUIRE(store);
    session = example_session(*store, "P1", 1, 1);
    REQUIRE(store->begin_step(example_step(session, 1)));
    const auto stream = store->open_stream(pose_header(session, 1));
    REQUIRE(stream);
    const double record[] = {0, 1, 2, 3};
    for (int k = 0; k < 500; ++k) (*stream)->push(record);
  }
  const auto file = folder.path / "a.streams" / (session + "-pose-1-1.stream");
  std::ofstream(file, std::ios::app | std::ios::binary) << "FRM1 torn";
  auto store = Store::open(folder.path / "a.sqlite", StoreAccess::write);
  REQUIRE(store);
  const auto rows = store->streams_of(session);
  REQUIRE(rows);
  REQUIRE(rows->size() == 1);
  CHECK((*rows)[0].records == 500);
  CHECK(!(*rows)[0].is_complete);
  CHECK((*rows)[0].sha256 == hash_file(file)->sha256);
  // The next attempt at the step has a file of its own.
  const auto again = store->open_stream(pose_header(session, 1));
  REQUIRE(again);
  CHECK((*again)->header().attempt == 2);
}
