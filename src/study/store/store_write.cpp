// The rows that the runner writes into a store.
#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "study/store/sha256.h"
#include "study/store/store.h"

namespace intaglio::study {

namespace {

Value optional_value(const std::optional<std::int64_t>& number) {
  return number ? Value(*number) : Value();
}

bool is_pseudonym(const std::string& id) {
  return !id.empty() && id.size() <= 32 && std::all_of(id.begin(), id.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  });
}

}  // namespace

Result<void> Store::add_design(const DesignRow& design) {
  const auto known = database_.first("SELECT text_sha256 FROM designs WHERE hash = ?", {design.hash});
  if (!known) return tl::unexpected(known.error());
  const std::string hash = sha256(design.text);
  if (std::holds_alternative<std::monostate>(*known))
    return database_.run("INSERT INTO designs VALUES(?, ?, ?, ?, ?)",
                         {design.hash, design.name, design.text, hash, design.seed});
  if (as_text(*known) == hash) return {};
  return fail(path().string(), fmt::format("it has another design under the hash {}", printable(design.hash)),
              "");
}

Result<std::string> Store::begin_session(const NewSession& session) {
  const std::string& person = session.participant;
  const std::string where = fmt::format("participant \"{}\"", printable(person));
  if (!is_pseudonym(person))
    return fail(where, "is no pseudonym", "up to 32 letters, digits, - and _; never a name");
  const auto withdrawn = database_.count("SELECT count(*) FROM withdrawals WHERE participant_hash = ?",
                                         {sha256("withdrawn " + person)});
  if (!withdrawn) return tl::unexpected(withdrawn.error());
  if (*withdrawn > 0) return fail(where, "has withdrawn from this study", "give a new person another id");
  const auto design = database_.count("SELECT count(*) FROM designs WHERE hash = ?", {session.design_hash});
  if (!design) return tl::unexpected(design.error());
  if (*design == 0)
    return fail(path().string(), "it has no design " + printable(session.design_hash), "add_design()");
  bool is_known = false, is_equal = false;
  auto read = database_.query(
      "SELECT number, synthetic FROM participants WHERE id = ?", {person}, [&](const Row& row) {
        is_known = true;
        is_equal = row.integer(0) == session.participant_number && (row.integer(1) != 0) == session.synthetic;
      });
  if (!read) return tl::unexpected(read.error());
  if (is_known && !is_equal)
    return fail(where,
                "is in the store with another number, or is synthetic in one and a person in the other", "");
  const std::string id = random_id();
  const std::int64_t synthetic = session.synthetic ? 1 : 0, wall = now("");
  auto done = database_.transaction([&]() -> Result<void> {
    if (!is_known)
      if (auto added = database_.run("INSERT INTO participants VALUES(?, ?, ?, ?)",
                                     {person, session.participant_number, synthetic, id_});
          !added)
        return added;
    return database_.run("INSERT INTO sessions VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, NULL, 'running')",
                         {id, person, session.design_hash, session.build, session.device, session.settings,
                          session.consent_version, session.consent_hash, synthetic, id_, wall});
  });
  if (!done) return tl::unexpected(done.error());
  return id;
}

Result<void> Store::end_session(const std::string& session, const std::string& outcome) {
  return database_.run("UPDATE sessions SET ended_ms = ?, outcome = ? WHERE id = ?",
                       {now(session), outcome, session});
}

Result<bool> Store::is_synthetic(const std::string& session) const {
  const auto found = database_.first("SELECT synthetic FROM sessions WHERE id = ?", {session});
  if (!found) return tl::unexpected(found.error());
  if (std::holds_alternative<std::monostate>(*found))
    return fail(path().string(), "it has no session " + printable(session), "");
  return as_integer(*found) != 0;
}

Result<void> Store::begin_step(const StepRow& step) {
  const auto synthetic = is_synthetic(step.session);
  if (!synthetic) return tl::unexpected(synthetic.error());
  auto steps = steps_of(step.session);
  if (!steps) return tl::unexpected(steps.error());
  const auto before =
      std::find_if(steps->begin(), steps->end(), [&](const StepRow& s) { return s.number == step.number; });
  if (before != steps->end()) {
    const auto content = [](const StepRow& s) {
      return std::tie(s.kind, s.block, s.trial, s.material, s.representation, s.cues, s.conditions);
    };
    if (content(*before) != content(step))
      return fail(path().string(), fmt::format("step {} was begun with another content", step.number),
                  "resume with the design and the participant's number of the session");
    return database_.run("UPDATE steps SET attempts = attempts + 1 WHERE session = ? AND number = ?",
                         {step.session, step.number});
  }
  return database_.transaction([&]() -> Result<void> {
    auto done = database_.run(
        "INSERT INTO steps VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, NULL, 1, ?)",
        {step.session, step.number, step.kind, step.block, optional_value(step.trial), step.material,
         step.representation, step.cues, step.started_s, std::int64_t(*synthetic ? 1 : 0)});
    for (const auto& [key, value] : step.conditions)
      if (done)
        done = database_.run("INSERT INTO conditions VALUES(?, ?, ?, ?)",
                             {step.session, step.number, key, value});
    return done;
  });
}

Result<void> Store::answer(const AnswerRow& answer) {
  const auto synthetic = is_synthetic(answer.session);
  if (!synthetic) return tl::unexpected(synthetic.error());
  const auto known =
      database_.count("SELECT count(*) FROM answers WHERE session = ? AND step = ? AND item = ?",
                      {answer.session, answer.step, answer.item});
  if (!known) return tl::unexpected(known.error());
  if (*known > 0)
    return fail(path().string(),
                fmt::format("step {} has an answer to \"{}\" already", answer.step, printable(answer.item)),
                "");
  const std::int64_t wall = now(answer.session);
  return database_.run(
      "INSERT INTO answers SELECT ?1, coalesce(max(sequence), 0) + 1, ?2, ?3, ?4, ?5, ?6, ?7 FROM answers WHERE "
      "session = ?1",
      {answer.session, answer.step, answer.item, answer.value, answer.seconds, wall,
       std::int64_t(*synthetic ? 1 : 0)});
}

Result<void> Store::insert_checkpoint(const std::string& session, const Checkpoint& checkpoint) {
  return database_.run(
      "INSERT INTO checkpoints SELECT ?1, coalesce(max(sequence), 0) + 1, ?2, ?3, ?4, ?5, ?6 FROM checkpoints WHERE "
      "session = ?1",
      {session, checkpoint.next_step, checkpoint.seconds, checkpoint.procedures, checkpoint.generator,
       now(session)});
}

Result<void> Store::save_checkpoint(const std::string& session, const Checkpoint& checkpoint) {
  return insert_checkpoint(session, checkpoint);
}

Result<void> Store::finish_step(const std::string& session, std::int64_t step, double seconds,
                                const Checkpoint& checkpoint) {
  if (const auto closed = close_streams(session); !closed) return tl::unexpected(closed.error());
  return database_.transaction([&]() -> Result<void> {
    auto done = database_.run("UPDATE steps SET ended_s = ? WHERE session = ? AND number = ?",
                              {seconds, session, step});
    if (done) done = insert_checkpoint(session, checkpoint);
    return done;
  });
}

Result<void> Store::insert_event(const EventRow& event, std::int64_t wall_ms) {
  const auto synthetic = is_synthetic(event.session);
  if (!synthetic) return tl::unexpected(synthetic.error());
  return database_.run(
      "INSERT INTO events SELECT ?1, coalesce(max(sequence), 0) + 1, ?2, ?3, ?4, ?5, ?6, ?7 FROM events WHERE "
      "session = ?1",
      {event.session, event.kind, optional_value(event.step), event.detail, event.seconds, wall_ms,
       std::int64_t(*synthetic ? 1 : 0)});
}

Result<void> Store::add_event(const EventRow& event) {
  return insert_event(event, now(event.session));
}

Result<void> Store::set_quality(const QualityRow& quality) {
  return database_.run(
      "INSERT INTO quality VALUES(?, ?, ?, ?) ON CONFLICT(session, step, counter) DO UPDATE SET value = "
      "excluded.value",
      {quality.session, quality.step, quality.counter, quality.value});
}

Result<void> Store::count_refusal(const std::string& design_hash) {
  return database_.run(
      "INSERT INTO refusals VALUES(?, ?, 1) ON CONFLICT(design, origin) DO UPDATE SET count = count + 1",
      {design_hash, id_});
}

Result<void> Store::add_export(const std::string& kind, const std::string& target,
                               const std::vector<std::string>& participants) {
  const std::string id = random_id();
  return database_.transaction([&]() -> Result<void> {
    auto done = database_.run("INSERT INTO exports VALUES(?, ?, ?, ?)", {id, now(""), kind, target});
    for (const std::string& participant : participants)
      if (done) done = database_.run("INSERT INTO export_participants VALUES(?, ?)", {id, participant});
    return done;
  });
}

Result<Stream*> Store::open_stream(StreamHeader header) {
  const auto synthetic = is_synthetic(header.session);
  if (!synthetic) return tl::unexpected(synthetic.error());
  header.synthetic = *synthetic;
  const auto before =
      database_.count("SELECT max(attempt) FROM streams WHERE session = ? AND step = ? AND stream = ?",
                      {header.session, header.step, header.name});
  if (!before) return tl::unexpected(before.error());
  header.attempt = *before + 1;
  if (auto checked = check_header(header); !checked) return tl::unexpected(checked.error());
  const std::string file =
      fmt::format("{}-{}-{}-{}.stream", header.session, header.name, header.step, header.attempt);
  // The row comes first, so that no file is without one, whenever the process ends.
  auto added = database_.run("INSERT INTO streams VALUES(?, ?, ?, ?, ?, NULL, 0, 0, 0, 0)",
                             {header.session, header.step, header.name, header.attempt, file});
  if (!added) return tl::unexpected(added.error());
  auto stream = recorder_->open(streams_folder() / file, header);
  if (!stream) {
    (void)database_.run("DELETE FROM streams WHERE file = ?", {file});
    return tl::unexpected(stream.error());
  }
  streams_.push_back(*stream);
  return *stream;
}

Result<std::uint64_t> Store::close_streams(const std::string& session) {
  std::uint64_t dropped = 0;
  while (!streams_.empty()) {
    const StreamHeader header = streams_.back()->header();
    const auto end = recorder_->close(streams_.back());
    streams_.pop_back();
    if (!end) return tl::unexpected(end.error());
    dropped += end->dropped;
    const std::string file =
        fmt::format("{}-{}-{}-{}.stream", header.session, header.name, header.step, header.attempt);
    const auto hashed = hash_file(streams_folder() / file);
    if (!hashed) return tl::unexpected(hashed.error());
    auto stored = database_.run(
        "UPDATE streams SET sha256 = ?, bytes = ?, records = ?, dropped = ?, complete = 1 WHERE file = ?",
        {hashed->sha256, hashed->bytes, std::int64_t(end->records), std::int64_t(end->dropped), file});
    if (!stored) return tl::unexpected(stored.error());
  }
  (void)session;
  return dropped;
}

std::optional<Error> Store::stream_error() const {
  return recorder_ ? recorder_->error() : std::nullopt;
}

}  // namespace intaglio::study
