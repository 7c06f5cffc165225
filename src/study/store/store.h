// A study store: what people answered, durable row by row, in one SQLite file NAME.sqlite and a folder
// NAME.streams of high-rate files beside it. It gives no meaning to what it keeps.
//
//   auto store = Store::open("study.sqlite", StoreAccess::create);
//   store->add_design(design);
//   const auto session = store->begin_session(who);
//   store->begin_step(step);                       // a row of the plan
//   store->answer({.session = *session, .step = 3, .item = "material", .value = "brick", .seconds = 41.2});
//   store->finish_step(*session, 3, 42, {.next_step = 4, .seconds = 42, ...});
//
// A row is acknowledged when its function has returned without an error: it is on the disk then, and neither
// SIGKILL nor a failure of power loses it. After a crash, resumable() says which session to go on with and
// where; a step that was begun is begun again, with the answers that it has.
//
// One process writes at a time, any number read meanwhile. Order is by sequence numbers, never by clocks; a
// clock that is set back is noted as an event. One thread at a time; Stream::push() from real-time threads. A
// durable row takes one fsync, 1 to 20 ms.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "intaglio/error.h"
#include "study/store/database.h"
#include "study/store/rows.h"
#include "study/store/stream_recorder.h"

namespace intaglio::study {

enum class StoreAccess { read, write, create };  // create: makes the store where there is none

struct StoreOptions {
  std::function<std::int64_t()> wall_ms;  // ms since 1970; by default the machine's clock
};

// A session that was interrupted.
struct Resumable {
  SessionRow session;
  Checkpoint checkpoint;
};

class Store {
 public:
  // Errors: no such file, no store, damaged, a newer schema, not writable, another process writes (who).
  static Result<Store> open(const std::filesystem::path& path, StoreAccess access, StoreOptions options = {});
  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;
  ~Store();

  // --- Writing ---
  // The same design may be added again. Error: another text under the same hash.
  Result<void> add_design(const DesignRow& design);
  // Returns the session's id. Errors: an id that is none, or that was withdrawn; a number or a kind (person
  // or synthetic) that is not the participant's; no such design.
  Result<std::string> begin_session(const NewSession& session);
  Result<void> end_session(const std::string& session, const std::string& outcome);
  // Begins a step, or begins it again. Error: it was begun with another content.
  Result<void> begin_step(const StepRow& step);
  // Error: the item is answered already (its step was begun again: see answers_of()).
  Result<void> answer(const AnswerRow& answer);
  // Ends a step and saves where the session goes on, in one transaction. Closes the step's streams first.
  Result<void> finish_step(const std::string& session, std::int64_t step, double seconds,
                           const Checkpoint& checkpoint);
  Result<void> save_checkpoint(const std::string& session, const Checkpoint& checkpoint);
  Result<void> add_event(const EventRow& event);
  Result<void> set_quality(const QualityRow& quality);
  // Somebody did not consent: a count, nothing else.
  Result<void> count_refusal(const std::string& design_hash);
  Result<void> add_export(const std::string& kind, const std::string& target,
                          const std::vector<std::string>& participants);

  // A high-rate file of a step that was begun. The stream is valid until close_streams().
  Result<Stream*> open_stream(StreamHeader header);
  // At a trial's end: writes what is left and stores the files' hashes. Returns the records dropped.
  Result<std::uint64_t> close_streams(const std::string& session);
  // A failure to write streams that are open.
  std::optional<Error> stream_error() const;

  // --- Reading ---
  Result<std::vector<DesignRow>> designs() const;
  Result<std::vector<SessionRow>> sessions() const;
  Result<std::vector<StepRow>> steps_of(const std::string& session) const;
  Result<std::vector<AnswerRow>> answers_of(const std::string& session) const;
  Result<std::vector<EventRow>> events_of(const std::string& session) const;
  Result<std::vector<QualityRow>> quality_of(const std::string& session) const;
  Result<std::vector<StreamRow>> streams_of(const std::string& session) const;
  Result<std::optional<Checkpoint>> checkpoint_of(const std::string& session) const;
  // The newest session of a participant that has not ended.
  Result<std::optional<Resumable>> resumable(const std::string& participant) const;
  Result<std::int64_t> refusals() const;
  Result<std::vector<ExportRow>> exports_with(const std::string& participant) const;

  // Warnings for the experimenter since the last call, such as a clock that was set back.
  std::vector<std::string> take_notices();

  const std::filesystem::path& path() const { return database_.path(); }
  std::filesystem::path streams_folder() const;
  // The name of this store, which merges keep.
  const std::string& id() const { return id_; }
  Database& database() { return database_; }
  const Database& database() const { return database_; }

 private:
  struct Lock;
  Store(Database database, StoreOptions options);
  Result<void> lock_for_writing();
  Result<void> recover();
  std::int64_t now(const std::string& session);
  Result<bool> is_synthetic(const std::string& session) const;
  Result<void> insert_event(const EventRow& event, std::int64_t wall_ms);
  Result<void> insert_checkpoint(const std::string& session, const Checkpoint& checkpoint);

  Database database_;
  StoreOptions options_;
  std::string id_;
  std::unique_ptr<Lock> lock_;
  std::unique_ptr<StreamRecorder> recorder_;
  std::vector<Stream*> streams_;
  std::int64_t last_wall_ms_ = 0;
  std::vector<std::string> notices_;
};

// 32 hexadecimal digits from the system's generator of random numbers.
std::string random_id();
// The folder of high-rate files beside a store.
std::filesystem::path streams_folder_of(const std::filesystem::path& store);
// 2026-12-01T10:21:07Z
std::string utc_text(std::int64_t wall_ms);

}  // namespace intaglio::study
