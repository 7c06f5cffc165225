#include "study/store/withdraw.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/text.h"
#include "study/store/schema.h"
#include "study/store/sha256.h"

namespace intaglio::study {

namespace {

Result<void> delete_rows(Database& database, const std::string& participant) {
  const std::string sessions = "(SELECT id FROM sessions WHERE participant = ?)";
  auto done = database.run(
      "INSERT OR IGNORE INTO files_to_delete SELECT file FROM streams WHERE session IN " + sessions,
      {participant});
  // Backwards: a row goes before the row that it refers to.
  for (auto table = std::rbegin(session_tables); done && table != std::rend(session_tables); ++table)
    done = database.run(fmt::format("DELETE FROM {} WHERE {} IN {}", *table, "session", sessions),
                        {participant});
  for (const char* rest :
       {"DELETE FROM sessions WHERE participant = ?", "DELETE FROM participants WHERE id = ?",
        "DELETE FROM export_participants WHERE participant = ?"})
    if (done) done = database.run(rest, {participant});
  return done;
}

}  // namespace

Result<Withdrawal> withdraw(Store& store, const std::string& participant) {
  Database& database = store.database();
  const auto sessions = database.count("SELECT count(*) FROM sessions WHERE participant = ?", {participant});
  if (!sessions) return tl::unexpected(sessions.error());
  const std::string hash = sha256("withdrawn " + participant);
  const auto before = database.count("SELECT count(*) FROM withdrawals WHERE participant_hash = ?", {hash});
  if (!before) return tl::unexpected(before.error());
  if (*sessions == 0 && *before == 0)
    return fail(store.path().string(), fmt::format("it has no participant \"{}\"", printable(participant)),
                "");
  auto exports = store.exports_with(participant);
  if (!exports) return tl::unexpected(exports.error());
  auto done = database.transaction([&]() -> Result<void> {
    if (auto deleted = delete_rows(database, participant); !deleted) return deleted;
    return database.run("INSERT OR IGNORE INTO withdrawals VALUES(?, 0)", {hash});
  });
  if (!done) return tl::unexpected(done.error());
  Withdrawal result{*sessions, 0, std::move(*exports)};
  std::vector<std::string> files;
  done = database.query("SELECT file FROM files_to_delete", {},
                        [&](const Row& row) { files.push_back(row.text(0)); });
  if (!done) return tl::unexpected(done.error());
  for (const std::string& file : files) {
    std::error_code failed;
    if (std::filesystem::remove(store.streams_folder() / file, failed)) ++result.files;
    if (failed)
      return fail((store.streams_folder() / file).string(), "cannot be removed: " + failed.message());
  }
  done = database.run("DELETE FROM files_to_delete");
  if (done) done = database.truncate_log();
  if (done) done = database.run("VACUUM");
  if (done) done = database.truncate_log();
  if (!done) return tl::unexpected(done.error());
  return result;
}

}  // namespace intaglio::study
