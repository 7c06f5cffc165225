#include "study/store/schema.h"

#include <fmt/format.h>

namespace intaglio::study {

namespace {

constexpr std::int64_t store_application_id = 0x494e5447;  // "INTG"

// A column of times in ms is the machine's clock, which may be set back; orders are by `sequence`.
constexpr const char* schema_sql = R"(
CREATE TABLE info(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE designs(
  hash TEXT PRIMARY KEY, name TEXT NOT NULL, text TEXT NOT NULL, text_sha256 TEXT NOT NULL,
  seed INTEGER NOT NULL) WITHOUT ROWID;
CREATE TABLE participants(
  id TEXT PRIMARY KEY, number INTEGER NOT NULL, synthetic INTEGER NOT NULL CHECK(synthetic IN (0, 1)),
  origin TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE sessions(
  id TEXT PRIMARY KEY, participant TEXT NOT NULL REFERENCES participants(id),
  design TEXT NOT NULL REFERENCES designs(hash), build TEXT NOT NULL, device TEXT NOT NULL,
  settings TEXT NOT NULL, consent_version TEXT NOT NULL, consent_hash TEXT NOT NULL,
  synthetic INTEGER NOT NULL CHECK(synthetic IN (0, 1)), origin TEXT NOT NULL, started_ms INTEGER NOT NULL,
  ended_ms INTEGER, outcome TEXT NOT NULL) WITHOUT ROWID;
CREATE INDEX sessions_of_participant ON sessions(participant);
CREATE TABLE steps(
  session TEXT NOT NULL REFERENCES sessions(id), number INTEGER NOT NULL, kind TEXT NOT NULL,
  block TEXT NOT NULL, trial INTEGER, material TEXT NOT NULL, representation TEXT NOT NULL,
  cues TEXT NOT NULL, started_s REAL NOT NULL, ended_s REAL, attempts INTEGER NOT NULL,
  synthetic INTEGER NOT NULL, PRIMARY KEY(session, number)) WITHOUT ROWID;
CREATE TABLE conditions(
  session TEXT NOT NULL, step INTEGER NOT NULL, key TEXT NOT NULL, value TEXT NOT NULL,
  PRIMARY KEY(session, step, key), FOREIGN KEY(session, step) REFERENCES steps(session, number)) WITHOUT ROWID;
CREATE TABLE answers(
  session TEXT NOT NULL, sequence INTEGER NOT NULL, step INTEGER NOT NULL, item TEXT NOT NULL,
  value TEXT NOT NULL, seconds REAL NOT NULL, wall_ms INTEGER NOT NULL, synthetic INTEGER NOT NULL,
  PRIMARY KEY(session, sequence), UNIQUE(session, step, item),
  FOREIGN KEY(session, step) REFERENCES steps(session, number)) WITHOUT ROWID;
CREATE TABLE events(
  session TEXT NOT NULL REFERENCES sessions(id), sequence INTEGER NOT NULL, kind TEXT NOT NULL, step INTEGER,
  detail TEXT NOT NULL, seconds REAL NOT NULL, wall_ms INTEGER NOT NULL, synthetic INTEGER NOT NULL,
  PRIMARY KEY(session, sequence)) WITHOUT ROWID;
CREATE TABLE quality(
  session TEXT NOT NULL, step INTEGER NOT NULL, counter TEXT NOT NULL, value INTEGER NOT NULL,
  PRIMARY KEY(session, step, counter), FOREIGN KEY(session, step) REFERENCES steps(session, number)) WITHOUT ROWID;
CREATE TABLE checkpoints(
  session TEXT NOT NULL REFERENCES sessions(id), sequence INTEGER NOT NULL, next_step INTEGER NOT NULL,
  seconds REAL NOT NULL, procedures TEXT NOT NULL, generator TEXT NOT NULL, wall_ms INTEGER NOT NULL,
  PRIMARY KEY(session, sequence)) WITHOUT ROWID;
CREATE TABLE streams(
  session TEXT NOT NULL REFERENCES sessions(id), step INTEGER NOT NULL, stream TEXT NOT NULL,
  attempt INTEGER NOT NULL, file TEXT NOT NULL UNIQUE, sha256 TEXT, bytes INTEGER NOT NULL,
  records INTEGER NOT NULL, dropped INTEGER NOT NULL, complete INTEGER NOT NULL,
  PRIMARY KEY(session, step, stream, attempt)) WITHOUT ROWID;
CREATE TABLE refusals(design TEXT, origin TEXT, count INTEGER NOT NULL, PRIMARY KEY(design, origin)) WITHOUT ROWID;
CREATE TABLE exports(id TEXT PRIMARY KEY, made_ms INTEGER NOT NULL, kind TEXT NOT NULL, target TEXT NOT NULL)
  WITHOUT ROWID;
CREATE TABLE export_participants(
  export TEXT NOT NULL REFERENCES exports(id), participant TEXT NOT NULL,
  PRIMARY KEY(export, participant)) WITHOUT ROWID;
CREATE TABLE withdrawals(participant_hash TEXT PRIMARY KEY, wall_ms INTEGER NOT NULL) WITHOUT ROWID;
CREATE TABLE files_to_delete(file TEXT PRIMARY KEY) WITHOUT ROWID;
)";

}  // namespace

Result<bool> is_empty_database(const Database& database) {
  return database.count("SELECT count(*) FROM sqlite_master").map([](std::int64_t count) {
    return count == 0;
  });
}

Result<void> create_schema(Database& database, const std::string& store_id) {
  return database.transaction([&]() -> Result<void> {
    if (auto made = database.run_all(schema_sql); !made) return made;
    if (auto named = database.run("INSERT INTO info VALUES('store', ?)", {store_id}); !named) return named;
    return database.run_all(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {};",
                                        store_application_id, store_schema_version));
  });
}

Result<void> check_schema(const Database& database) {
  const std::string where = database.path().string();
  const auto application = database.count("PRAGMA application_id");
  if (!application) return tl::unexpected(application.error());
  if (*application != store_application_id)
    return fail(where, "this is not a study store, but another program's database", "");
  const auto version = database.count("PRAGMA user_version");
  if (!version) return tl::unexpected(version.error());
  if (*version > store_schema_version)
    return fail(where,
                fmt::format("a newer Intaglio made it: its schema is {}, this one knows {}", *version,
                            store_schema_version),
                "use that version, or a newer one");
  if (*version < 1) return fail(where, fmt::format("its schema has the version {}", *version), "from 1");
  std::string damage;
  auto checked = database.query("PRAGMA quick_check(1)", {}, [&](const Row& row) { damage = row.text(0); });
  if (!checked) return checked;
  if (damage != "ok")
    return fail(where, "the file is damaged", "take a copy of it, then recover it by: sqlite3 FILE .recover");
  return {};
}

}  // namespace intaglio::study
