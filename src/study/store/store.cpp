#include "study/store/store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>

#include "core/output_files.h"
#include "study/store/schema.h"
#include "study/store/sha256.h"

namespace intaglio::study {

namespace {

constexpr std::int64_t noticed_clock_step_ms = 1000;

std::int64_t system_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "an unknown host";
}

// A store is named in the directory only after this; SQLite does it for its logs alone.
void sync_folder_of(const std::filesystem::path& path) {
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  (void)::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

std::string random_id() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != ssize_t(bytes.size()))
    std::abort();  // never, up to 256 bytes
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

std::filesystem::path streams_folder_of(const std::filesystem::path& store) {
  std::filesystem::path folder = store;
  return folder.replace_extension(".streams");
}

std::string utc_text(std::int64_t wall_ms) {
  const std::time_t seconds = std::time_t(wall_ms / 1000);
  std::tm parts{};
  std::array<char, 32> text{};
  if (::gmtime_r(&seconds, &parts) == nullptr ||
      std::strftime(text.data(), text.size(), "%FT%TZ", &parts) == 0)
    return "an unknown time";
  return text.data();
}

// The lock is held on the folder of streams: on the database itself it would disturb SQLite's own, which
// closing any descriptor of the file releases.
struct Store::Lock {
  int descriptor = -1;
  ~Lock() {
    if (descriptor >= 0) ::close(descriptor);
  }
};

Store::Store(Database database, StoreOptions options)
    : database_(std::move(database)), options_(std::move(options)) {
  if (!options_.wall_ms) options_.wall_ms = system_ms;
}
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;
Store::~Store() = default;

std::filesystem::path Store::streams_folder() const {
  return streams_folder_of(path());
}

Result<Store> Store::open(const std::filesystem::path& path, StoreAccess access, StoreOptions options) {
  if (path.extension() != ".sqlite")
    return fail(path.string(), "a study store has another name", "NAME.sqlite");
  std::error_code ignored;
  const bool is_new = access == StoreAccess::create && !std::filesystem::exists(path, ignored);
  if (is_new && path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), ignored);
  auto database = Database::open(path, access == StoreAccess::read    ? Database::Access::read
                                       : access == StoreAccess::write ? Database::Access::write
                                                                      : Database::Access::create);
  if (!database) return tl::unexpected(database.error());
  Store store(std::move(*database), std::move(options));
  const auto is_empty = is_empty_database(store.database_);
  if (!is_empty) return tl::unexpected(is_empty.error());
  if (*is_empty && access != StoreAccess::create)
    return fail(path.string(), "this is an empty file, not a study store", "");
  if (!*is_empty)
    if (auto checked = check_schema(store.database_); !checked) return tl::unexpected(checked.error());
  if (access != StoreAccess::read) {
    if (auto locked = store.lock_for_writing(); !locked) return tl::unexpected(locked.error());
    if (auto durable = store.database_.write_durably(); !durable) return tl::unexpected(durable.error());
    if (*is_empty)
      if (auto created = create_schema(store.database_, random_id()); !created)
        return tl::unexpected(created.error());
    if (is_new) sync_folder_of(path);
  }
  const auto id = store.database_.first("SELECT value FROM info WHERE key = 'store'");
  if (!id) return tl::unexpected(id.error());
  store.id_ = as_text(*id);
  if (access != StoreAccess::read)
    if (auto recovered = store.recover(); !recovered) return tl::unexpected(recovered.error());
  return store;
}

Result<void> Store::lock_for_writing() {
  const std::filesystem::path folder = streams_folder();
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) return fail(folder.string(), "cannot be made: " + failed.message(), "");
  lock_ = std::make_unique<Lock>();
  lock_->descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_->descriptor < 0)
    return fail(folder.string(), fmt::format("cannot be opened: {}", std::strerror(errno)));
  if (::access(folder.c_str(), W_OK) != 0) return tl::unexpected(write_error(folder, errno));
  if (::flock(lock_->descriptor, LOCK_EX | LOCK_NB) == 0) return {};
  if (errno != EWOULDBLOCK)
    return fail(folder.string(), fmt::format("cannot be locked: {}", std::strerror(errno)),
                "keep the store on a local disk");
  const auto holder = database_.first("SELECT value FROM info WHERE key = 'writer'");
  const std::string who = holder ? as_text(*holder) : std::string();
  return fail(path().string(),
              (who.empty() ? std::string("another process") : who) + " has it open for writing",
              "wait for it, or end it; reading is possible meanwhile");
}

Result<void> Store::recover() {
  recorder_ = std::make_unique<StreamRecorder>();
  std::vector<StreamRow> torn;
  std::vector<std::string> doomed;
  auto read = database_.query("SELECT session, step, stream, attempt, file FROM streams WHERE sha256 IS NULL",
                              {}, [&](const Row& row) {
                                StreamRow& stream = torn.emplace_back();
                                stream.session = row.text(0);
                                stream.step = row.integer(1);
                                stream.stream = row.text(2);
                                stream.attempt = row.integer(3);
                                stream.file = row.text(4);
                              });
  if (read)
    read = database_.query("SELECT file FROM files_to_delete", {},
                           [&](const Row& row) { doomed.push_back(row.text(0)); });
  const auto newest = database_.count(
      "SELECT max(t) FROM (SELECT max(wall_ms) t FROM answers UNION ALL SELECT max(wall_ms) FROM events "
      "UNION ALL SELECT max(wall_ms) FROM checkpoints UNION ALL SELECT max(started_ms) FROM sessions)");
  if (!read) return read;
  if (!newest) return tl::unexpected(newest.error());
  last_wall_ms_ = *newest;
  std::error_code ignored;
  for (const std::string& file : doomed) std::filesystem::remove(streams_folder() / file, ignored);
  return database_.transaction([&]() -> Result<void> {
    const auto process = std::int64_t(::getpid());  // Not in a name
    const std::string writer =
        fmt::format("process {} on {}, since {},", process, host_name(), utc_text(options_.wall_ms()));
    auto done = database_.run(
        "INSERT INTO info VALUES('writer', ?) ON CONFLICT(key) DO UPDATE SET value = "
        "excluded.value",
        {writer});
    if (done) done = database_.run("DELETE FROM files_to_delete");
    for (const StreamRow& stream : torn) {
      if (!done) return done;
      const std::vector<Value> key{stream.session, stream.step, stream.stream, stream.attempt};
      const auto hashed = hash_file(streams_folder() / stream.file);
      if (!hashed) {  // its process was killed before the file was made
        done = database_.run(
            "DELETE FROM streams WHERE session = ? AND step = ? AND stream = ? AND attempt = ?", key);
        continue;
      }
      const auto file = load_stream(streams_folder() / stream.file);
      std::vector<Value> values{hashed->sha256, hashed->bytes, std::int64_t(file ? file->rows() : 0),
                                std::int64_t(file ? file->dropped : 0)};
      values.insert(values.end(), key.begin(), key.end());
      done = database_.run(
          "UPDATE streams SET sha256 = ?, bytes = ?, records = ?, dropped = ?, complete = 0 WHERE session = ? AND "
          "step = ? AND stream = ? AND attempt = ?",
          values);
    }
    return done;
  });
}

std::int64_t Store::now(const std::string& session) {
  const std::int64_t wall = options_.wall_ms();
  if (wall < last_wall_ms_ - noticed_clock_step_ms) {
    const std::string detail = fmt::format("from {} to {}", utc_text(last_wall_ms_), utc_text(wall));
    notices_.push_back("this machine's clock was set back " + detail +
                       "; nothing is lost, the order of rows is kept");
    if (!session.empty()) (void)insert_event({session, "clock_set_back", {}, detail, 0, wall, false}, wall);
    last_wall_ms_ = wall;
  }
  last_wall_ms_ = std::max(last_wall_ms_, wall);
  return wall;
}

std::vector<std::string> Store::take_notices() {
  return std::exchange(notices_, {});
}

}  // namespace intaglio::study
