#include "study/store/database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <cerrno>
#include <cstring>

#include "core/text.h"

namespace intaglio::study {

int Row::columns() const {
  return sqlite3_column_count(statement_);
}
bool Row::is_null(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}
std::int64_t Row::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}
double Row::real(int column) const {
  return sqlite3_column_double(statement_, column);
}

std::string Row::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  return text == nullptr ? std::string()
                         : std::string(text, std::size_t(sqlite3_column_bytes(statement_, column)));
}

Value Row::value(int column) const {
  switch (sqlite3_column_type(statement_, column)) {
    case SQLITE_NULL:
      return std::monostate();
    case SQLITE_INTEGER:
      return integer(column);
    case SQLITE_FLOAT:
      return real(column);
    default:
      return text(column);
  }
}

std::int64_t as_integer(const Value& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return *integer;
  if (const auto* real = std::get_if<double>(&value)) return std::int64_t(*real);
  return 0;
}

std::string as_text(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  if (const auto* real = std::get_if<double>(&value)) return fmt::format("{}", *real);
  return {};
}

namespace {

class Prepared {
 public:
  Prepared(sqlite3* handle, const std::string& sql, const std::vector<Value>& values) {
    code_ = sqlite3_prepare_v2(handle, sql.c_str(), int(sql.size()), &statement_, nullptr);
    for (std::size_t k = 0; k < values.size() && code_ == SQLITE_OK; ++k) bind(int(k) + 1, values[k]);
  }
  Prepared(const Prepared&) = delete;
  Prepared& operator=(const Prepared&) = delete;
  ~Prepared() { sqlite3_finalize(statement_); }

  int step() { return code_ == SQLITE_OK ? sqlite3_step(statement_) : code_; }
  sqlite3_stmt* get() const { return statement_; }

 private:
  void bind(int index, const Value& value) {
    if (const auto* integer = std::get_if<std::int64_t>(&value))
      code_ = sqlite3_bind_int64(statement_, index, *integer);
    else if (const auto* real = std::get_if<double>(&value))
      code_ = sqlite3_bind_double(statement_, index, *real);
    else if (const auto* text = std::get_if<std::string>(&value))
      code_ = sqlite3_bind_text(statement_, index, text->data(), int(text->size()), SQLITE_TRANSIENT);
    else
      code_ = sqlite3_bind_null(statement_, index);
  }

  sqlite3_stmt* statement_ = nullptr;
  int code_ = SQLITE_OK;
};

}  // namespace

void Database::Close::operator()(sqlite3* handle) const {
  sqlite3_close_v2(handle);
}

Error Database::error(int code) const {
  const std::string where = path_.string();
  const int reason = handle_ ? sqlite3_system_errno(handle_.get()) : 0;
  switch (code & 0xff) {
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return {where, "cannot be written: it, or its folder, is read-only", "make both writable"};
    case SQLITE_FULL:
      return {where, "the disk is full; all that was acknowledged before is stored",
              "free some space, then resume the session"};
    case SQLITE_CORRUPT:
      return {where, "the file is damaged", "take a copy of it, then recover it by: sqlite3 FILE .recover"};
    case SQLITE_NOTADB:
      return {where, "this is not a study store (no SQLite database)", ""};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {where, "another program keeps it locked", "close that program"};
    case SQLITE_CANTOPEN:
      return {where,
              fmt::format("cannot be opened: {}", reason == 0 ? "unknown reason" : std::strerror(reason)),
              ""};
    case SQLITE_NOMEM:
      return {where, "not enough memory", ""};
    case SQLITE_IOERR:
      if (reason == EDQUOT || reason == EFBIG || reason == ENOSPC)
        return {where,
                fmt::format("no room: {}; all that was acknowledged before is stored", std::strerror(reason)),
                "free some space, then resume the session"};
      return {where,
              fmt::format("reading or writing failed: {}; all that was acknowledged before is stored",
                          reason == 0 ? sqlite3_errstr(code) : std::strerror(reason)),
              "check the disk"};
    default:
      break;
  }
  return {where, printable(handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(code)), ""};
}

Result<Database> Database::open(const std::filesystem::path& path, Access access) {
  Database database;
  database.path_ = path;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return fail(path.string(), "is a folder", "name a study store, such as study.sqlite");
  if (access != Access::create && !std::filesystem::exists(path, ignored))
    return fail(path.string(), "no such file");
  const int flags = access == Access::read    ? SQLITE_OPEN_READONLY
                    : access == Access::write ? SQLITE_OPEN_READWRITE
                                              : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &handle, flags | SQLITE_OPEN_EXRESCODE, nullptr);
  database.handle_.reset(handle);
  if (code != SQLITE_OK) return tl::unexpected(database.error(code));
  if (access != Access::read && sqlite3_db_readonly(handle, "main") == 1)
    return tl::unexpected(database.error(SQLITE_READONLY));
  auto configured = database.configure();
  const int why = sqlite3_extended_errcode(handle);
  // Its writer was killed: rolling back what it had not committed takes write access, and loses nothing.
  if (!configured && access == Access::read &&
      (why == SQLITE_READONLY_ROLLBACK || why == SQLITE_READONLY_RECOVERY))
    return open(path, Access::write);
  if (!configured) return tl::unexpected(configured.error());
  return database;
}

Result<void> Database::configure() {
  sqlite3_busy_timeout(handle_.get(), 5000);
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  // Temporary tables stay in memory: otherwise a participant's content could reach the temporary folder.
  if (auto set =
          run_all("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA temp_store = MEMORY;"
                  "PRAGMA foreign_keys = ON;");
      !set)
    return set;
  // Reads the header, so that a file of another kind is recognised before its settings are read.
  if (auto header = first("PRAGMA schema_version"); !header) return tl::unexpected(header.error());
  return {};
}

Result<void> Database::write_durably() {
  const auto mode = first("PRAGMA journal_mode = WAL");
  if (!mode) return tl::unexpected(mode.error());
  if (as_text(*mode) != "wal")
    return fail(path_.string(), "its file system has no shared memory, which a study store needs",
                "keep the store on a local disk");
  return run_all("PRAGMA synchronous = FULL; PRAGMA secure_delete = ON;");
}

Result<void> Database::run(const std::string& sql, const std::vector<Value>& values) {
  return query(sql, values, [](const Row&) {});
}

Result<void> Database::run_all(const std::string& sql) {
  const int code = sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) return tl::unexpected(error(code));
  return {};
}

Result<void> Database::query(const std::string& sql, const std::vector<Value>& values,
                             const std::function<void(const Row&)>& row) const {
  Prepared statement(handle_.get(), sql, values);
  for (;;) {
    const int code = statement.step();
    if (code == SQLITE_DONE || code == SQLITE_OK) return {};
    if (code != SQLITE_ROW) return tl::unexpected(error(code));
    row(Row(statement.get()));
  }
}

Result<Value> Database::first(const std::string& sql, const std::vector<Value>& values) const {
  Prepared statement(handle_.get(), sql, values);
  const int code = statement.step();
  if (code == SQLITE_ROW) return Row(statement.get()).value(0);
  if (code != SQLITE_DONE) return tl::unexpected(error(code));
  return Value();
}

Result<std::int64_t> Database::count(const std::string& sql, const std::vector<Value>& values) const {
  return first(sql, values).map(as_integer);
}

Result<void> Database::transaction(const std::function<Result<void>()>& work) {
  if (auto begun = run("BEGIN IMMEDIATE"); !begun) return begun;
  auto done = work();
  if (done) done = run("COMMIT");
  // A failed statement may have ended the transaction itself.
  if (!done && sqlite3_get_autocommit(handle_.get()) == 0) (void)run("ROLLBACK");
  return done;
}

Result<void> Database::truncate_log() {
  std::int64_t busy = 0;
  auto done = query("PRAGMA wal_checkpoint(TRUNCATE)", {}, [&](const Row& row) { busy = row.integer(0); });
  if (!done) return done;
  if (busy != 0)
    return fail(path_.string(), "another program reads it, so its log cannot be truncated",
                "close that program");
  return {};
}

}  // namespace intaglio::study
