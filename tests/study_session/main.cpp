// A session that is killed, for tools/study_kill_trial.
//   study_session run STORE     begins or resumes a session of endless steps, in each of which four items are
//                               answered and a pose is recorded; prints what the store has acknowledged
//   study_session read STORE    prints all answers, checkpoints and the streams' ends
// Times are seconds of CLOCK_MONOTONIC, which all processes share.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <string>
#include <string_view>
#include <thread>

#include "core/file.h"
#include "study/store/store.h"

namespace {

using namespace intaglio;
using namespace intaglio::study;

double monotonic() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void say(const std::string& line) {
  if (write_fully(STDOUT_FILENO, line + "\n") != 0) ::_exit(3);
}

int failed(const Error& error) {
  say("error " + error.message());
  return 1;
}

// A device that gives a pose every millisecond of the clock, however late it is asked.
void record_poses(Stream* stream, std::atomic<bool>& ends, double& time) {
  while (!ends) {
    for (; time <= monotonic(); time += 0.001) {
      const double record[] = {time, time * 2, 0, 1};
      stream->push(record);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

Result<void> run_step(Store& store, const std::string& session, std::int64_t k) {
  StepRow step;
  step.session = session;
  step.number = k;
  step.kind = "trial";
  step.material = "m" + std::to_string(k % 10);
  step.started_s = double(k);
  step.conditions = {{"size", std::to_string(k)}};
  if (auto begun = store.begin_step(step); !begun) return begun;
  const auto before = store.answers_of(session);
  if (!before) return tl::unexpected(before.error());
  std::size_t known = 0;
  for (const AnswerRow& answer : *before) known += answer.step == k ? 1 : 0;
  StreamHeader header;
  header.name = "pose";
  header.session = session;
  header.step = k;
  header.rate_hz = 1000;
  header.columns = {{"time", "s", "LATENCY", "n/a", "n/a"},
                    {"x", "m", "POS", "x", "pen"},
                    {"y", "m", "POS", "y", "pen"},
                    {"z", "m", "POS", "z", "pen"}};
  const auto stream = store.open_stream(header);
  if (!stream) return tl::unexpected(stream.error());
  std::atomic<bool> ends = false;
  double time = monotonic();
  say(fmt::format("stream {} {}", k, (*stream)->header().attempt));
  std::thread device([&] { record_poses(*stream, ends, time); });
  Result<void> done;
  for (std::size_t item = known; item < 4 && done; ++item) {
    const std::string value = fmt::format("v{}", k * 31 + std::int64_t(item));
    done = store.answer({session, k, fmt::format("item{}", item), value, double(k), 0, false});
    if (done) say(fmt::format("answer {} item{} {}", k, item, value));
    std::this_thread::sleep_for(std::chrono::milliseconds(15));
  }
  ends = true;
  device.join();
  if (!done) return done;
  done = store.finish_step(session, k, double(k) + 0.5, {k + 1, double(k), "", fmt::format("g{}", k + 1)});
  if (done) say(fmt::format("checkpoint {}", k + 1));
  return done;
}

int run(const std::string& path) {
  auto store = Store::open(path, StoreAccess::create);
  if (!store) return failed(store.error());
  if (auto added = store->add_design({"hash", "kill", "text", 1}); !added) return failed(added.error());
  const auto resumed = store->resumable("P1");
  if (!resumed) return failed(resumed.error());
  std::string session;
  std::int64_t step = 0;
  if (*resumed) {
    session = (*resumed)->session.id;
    step = (*resumed)->checkpoint.next_step;
  } else {
    NewSession person;
    person.participant = "P1";
    person.participant_number = 1;
    person.design_hash = "hash";
    const auto begun = store->begin_session(person);
    if (!begun) return failed(begun.error());
    session = *begun;
  }
  say(fmt::format("resumed {}", step));
  for (;; ++step)
    if (auto done = run_step(*store, session, step); !done) return failed(done.error());
}

int read(const std::string& path) {
  const auto store = Store::open(path, StoreAccess::read);
  if (!store) return failed(store.error());
  const auto sessions = store->sessions();
  if (!sessions) return failed(sessions.error());
  for (const SessionRow& session : *sessions) {
    const auto answers = store->answers_of(session.id);
    const auto streams = store->streams_of(session.id);
    if (!answers || !streams) return failed(answers ? streams.error() : answers.error());
    for (const AnswerRow& answer : *answers)
      say(fmt::format("answer {} {} {}", answer.step, answer.item, answer.value));
    const auto checkpoint = store->checkpoint_of(session.id);
    say(fmt::format("checkpoint {}", checkpoint && *checkpoint ? (*checkpoint)->next_step : 0));
    for (const StreamRow& row : *streams) {
      const auto file = load_stream(store->streams_folder() / row.file);
      const std::size_t rows = file ? file->rows() : 0;
      say(fmt::format("stream {} {} {} {:.6f} {:.6f} {}", row.step, row.attempt, rows,
                      rows > 0 ? file->at(0, 0) : 0, rows > 0 ? file->at(rows - 1, 0) : 0,
                      file ? file->dropped : 0));
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  return std::string_view(argv[1]) == "run" ? run(argv[2]) : read(argv[2]);
}
