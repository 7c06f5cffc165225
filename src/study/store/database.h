// A SQLite file: statements with values, transactions, and each failure as one clear line. Written in WAL
// mode with synchronous = FULL: a transaction whose commit has returned is on the disk. Deleted content is
// overwritten (secure_delete). One thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "intaglio/error.h"

struct sqlite3;
struct sqlite3_stmt;

namespace intaglio::study {

// Nothing (NULL), a number or UTF-8 text.
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;

// A row of a query. Valid until the next one.
class Row {
 public:
  explicit Row(sqlite3_stmt* statement) : statement_(statement) {}
  int columns() const;
  bool is_null(int column) const;
  std::int64_t integer(int column) const;
  double real(int column) const;
  std::string text(int column) const;
  Value value(int column) const;

 private:
  sqlite3_stmt* statement_;
};

class Database {
 public:
  enum class Access { read, write, create };

  // create: makes the file where there is none. Errors: no such file, not a database, damaged, not writable.
  // Nothing of the file is changed before write_durably().
  static Result<Database> open(const std::filesystem::path& path, Access access);
  // WAL, synchronous = FULL, secure_delete. Error: its file system cannot do that.
  Result<void> write_durably();

  // One statement, its values in place of `?`.
  Result<void> run(const std::string& sql, const std::vector<Value>& values = {});
  // Several statements without values.
  Result<void> run_all(const std::string& sql);
  Result<void> query(const std::string& sql, const std::vector<Value>& values,
                     const std::function<void(const Row&)>& row) const;
  // The first column of the first row; NULL when there is none.
  Result<Value> first(const std::string& sql, const std::vector<Value>& values = {}) const;
  Result<std::int64_t> count(const std::string& sql, const std::vector<Value>& values = {}) const;

  // Runs `work` in one transaction: all of it is durable when this returns, or nothing of it happened.
  Result<void> transaction(const std::function<Result<void>()>& work);
  // Moves what the WAL holds into the file, and truncates the WAL.
  Result<void> truncate_log();

  const std::filesystem::path& path() const { return path_; }

 private:
  Error error(int code) const;
  Result<void> configure();

  struct Close {
    void operator()(sqlite3* handle) const;
  };
  std::filesystem::path path_;
  std::unique_ptr<sqlite3, Close> handle_;
};

// For rows whose absence is an error of the file.
std::int64_t as_integer(const Value& value);
std::string as_text(const Value& value);

}  // namespace intaglio::study
