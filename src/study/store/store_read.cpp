// The rows that analyses, exports and a resumed session read from a store.
#include "study/store/store.h"

namespace intaglio::study {

namespace {

std::optional<std::int64_t> optional_integer(const Row& row, int column) {
  return row.is_null(column) ? std::nullopt : std::optional(row.integer(column));
}

// All rows of a query, each made by `make`.
template <class T>
Result<std::vector<T>> all_rows(const Database& database, const std::string& sql,
                                const std::vector<Value>& values, const std::function<T(const Row&)>& make) {
  std::vector<T> rows;
  auto read = database.query(sql, values, [&](const Row& row) { rows.push_back(make(row)); });
  if (!read) return tl::unexpected(read.error());
  return rows;
}

}  // namespace

Result<std::vector<DesignRow>> Store::designs() const {
  return all_rows<DesignRow>(database_, "SELECT hash, name, text, seed FROM designs ORDER BY hash", {},
                             [](const Row& row) {
                               return DesignRow{row.text(0), row.text(1), row.text(2), row.integer(3)};
                             });
}

Result<std::vector<SessionRow>> Store::sessions() const {
  return all_rows<SessionRow>(
      database_,
      "SELECT s.id, s.participant, p.number, s.design, s.build, s.device, s.settings, s.consent_version, "
      "s.consent_hash, s.synthetic, s.origin, s.started_ms, s.ended_ms, s.outcome FROM sessions s JOIN participants p "
      "ON p.id = s.participant ORDER BY p.number, s.participant, s.started_ms, s.id",
      {}, [](const Row& row) {
        SessionRow session;
        session.id = row.text(0);
        session.participant = row.text(1);
        session.participant_number = row.integer(2);
        session.design_hash = row.text(3);
        session.build = row.text(4);
        session.device = row.text(5);
        session.settings = row.text(6);
        session.consent_version = row.text(7);
        session.consent_hash = row.text(8);
        session.synthetic = row.integer(9) != 0;
        session.origin = row.text(10);
        session.started_ms = row.integer(11);
        session.ended_ms = optional_integer(row, 12);
        session.outcome = row.text(13);
        return session;
      });
}

Result<std::vector<StepRow>> Store::steps_of(const std::string& session) const {
  auto steps = all_rows<StepRow>(
      database_,
      "SELECT session, number, kind, block, trial, material, representation, cues, started_s, ended_s, attempts, "
      "synthetic FROM steps WHERE session = ? ORDER BY number",
      {session}, [](const Row& row) {
        StepRow step;
        step.session = row.text(0);
        step.number = row.integer(1);
        step.kind = row.text(2);
        step.block = row.text(3);
        step.trial = optional_integer(row, 4);
        step.material = row.text(5);
        step.representation = row.text(6);
        step.cues = row.text(7);
        step.started_s = row.real(8);
        if (!row.is_null(9)) step.ended_s = row.real(9);
        step.attempts = row.integer(10);
        step.synthetic = row.integer(11) != 0;
        return step;
      });
  if (!steps) return steps;
  std::size_t at = 0;
  auto read = database_.query("SELECT step, key, value FROM conditions WHERE session = ? ORDER BY step",
                              {session}, [&](const Row& row) {
                                while (at < steps->size() && (*steps)[at].number < row.integer(0)) ++at;
                                if (at < steps->size()) (*steps)[at].conditions[row.text(1)] = row.text(2);
                              });
  if (!read) return tl::unexpected(read.error());
  return steps;
}

Result<std::vector<AnswerRow>> Store::answers_of(const std::string& session) const {
  return all_rows<AnswerRow>(
      database_,
      "SELECT session, step, item, value, seconds, wall_ms, synthetic FROM answers WHERE session = ? ORDER BY sequence",
      {session}, [](const Row& row) {
        return AnswerRow{row.text(0), row.integer(1), row.text(2),        row.text(3),
                         row.real(4), row.integer(5), row.integer(6) != 0};
      });
}

Result<std::vector<EventRow>> Store::events_of(const std::string& session) const {
  return all_rows<EventRow>(
      database_,
      "SELECT session, kind, step, detail, seconds, wall_ms, synthetic FROM events WHERE session = ? ORDER BY sequence",
      {session}, [](const Row& row) {
        return EventRow{row.text(0), row.text(1),    optional_integer(row, 2), row.text(3),
                        row.real(4), row.integer(5), row.integer(6) != 0};
      });
}

Result<std::vector<QualityRow>> Store::quality_of(const std::string& session) const {
  return all_rows<QualityRow>(
      database_, "SELECT session, step, counter, value FROM quality WHERE session = ? ORDER BY step, counter",
      {session}, [](const Row& row) {
        return QualityRow{row.text(0), row.integer(1), row.text(2), row.integer(3)};
      });
}

Result<std::vector<StreamRow>> Store::streams_of(const std::string& session) const {
  return all_rows<StreamRow>(
      database_,
      "SELECT session, stream, step, attempt, file, sha256, bytes, records, dropped, complete FROM streams WHERE "
      "session = ? ORDER BY step, stream, attempt",
      {session}, [](const Row& row) {
        StreamRow stream;
        stream.session = row.text(0);
        stream.stream = row.text(1);
        stream.step = row.integer(2);
        stream.attempt = row.integer(3);
        stream.file = row.text(4);
        if (!row.is_null(5)) stream.sha256 = row.text(5);
        stream.bytes = row.integer(6);
        stream.records = row.integer(7);
        stream.dropped = row.integer(8);
        stream.is_complete = row.integer(9) != 0;
        return stream;
      });
}

Result<std::optional<Checkpoint>> Store::checkpoint_of(const std::string& session) const {
  std::optional<Checkpoint> newest;
  auto read = database_.query(
      "SELECT next_step, seconds, procedures, generator FROM checkpoints WHERE session = ? ORDER BY sequence DESC "
      "LIMIT 1",
      {session}, [&](const Row& row) {
        newest = Checkpoint{row.integer(0), row.real(1), row.text(2), row.text(3)};
      });
  if (!read) return tl::unexpected(read.error());
  return newest;
}

Result<std::optional<Resumable>> Store::resumable(const std::string& participant) const {
  const auto all = sessions();
  if (!all) return tl::unexpected(all.error());
  std::optional<Resumable> newest;
  for (const SessionRow& session : *all)
    if (session.participant == participant && session.outcome == "running") newest = Resumable{session, {}};
  if (!newest) return newest;
  const auto checkpoint = checkpoint_of(newest->session.id);
  if (!checkpoint) return tl::unexpected(checkpoint.error());
  if (*checkpoint) newest->checkpoint = **checkpoint;
  return newest;
}

Result<std::int64_t> Store::refusals() const {
  return database_.count("SELECT total(count) FROM refusals");
}

Result<std::vector<ExportRow>> Store::exports_with(const std::string& participant) const {
  return all_rows<ExportRow>(
      database_,
      "SELECT made_ms, kind, target FROM exports JOIN export_participants ON export = id WHERE participant = ? ORDER "
      "BY made_ms, target",
      {participant}, [](const Row& row) {
        return ExportRow{row.integer(0), row.text(1), row.text(2)};
      });
}

}  // namespace intaglio::study
