// A study store: rows are durable and in order, a session resumes where it was, each error is one clear line.
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "study/store/sha256.h"
#include "study/store/store.h"
#include "tests/study/example_study.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::study;
using namespace intaglio::tests;

TEST_CASE("SHA-256 of the examples of FIPS 180-4") {
  CHECK(sha256("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  Sha256 pieces;
  for (int k = 0; k < 1000000; ++k) pieces.add("a");
  CHECK(pieces.finish() == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("a store that is opened again has all rows, and the session resumes at its checkpoint") {
  const TemporaryFolder folder;
  std::string session;
  {
    auto store = Store::open(folder.path / "a.sqlite", StoreAccess::create);
    REQUIRE(store);
    session = example_session(*store, "P1", 1, 3);
    REQUIRE(store->begin_step(example_step(session, 3)));
    REQUIRE(
        store->answer({.session = session, .step = 3, .item = "material", .value = "brick", .seconds = 30}));
  }
  auto store = Store::open(folder.path / "a.sqlite", StoreAccess::write);
  REQUIRE(store);
  const auto resumed = store->resumable("P1");
  REQUIRE(resumed);
  REQUIRE(resumed->has_value());
  CHECK((*resumed)->session.id == session);
  CHECK((*resumed)->checkpoint.next_step == 3);
  CHECK((*resumed)->checkpoint.generator == "state of 3");
  REQUIRE(store->begin_step(example_step(session, 3)));
  const auto steps = store->steps_of(session);
  REQUIRE(steps);
  REQUIRE(steps->size() == 4);
  CHECK((*steps)[3].attempts == 2);
  CHECK((*steps)[2].conditions.at("pen_sound") == "off");
  CHECK((*steps)[2].ended_s == 25);
  const auto answers = store->answers_of(session);
  REQUIRE(answers);
  CHECK(answers->size() == 7);
  CHECK(answers->back().value == "brick");
  const auto again = store->answer({.session = session, .step = 3, .item = "material", .value = "wood"});
  REQUIRE(!again);
  CHECK(again.error().what == "step 3 has an answer to \"material\" already");
  auto other = example_step(session, 3);
  other.material = "sand";
  CHECK(!store->begin_step(other));
  REQUIRE(store->end_session(session, "finished"));
  CHECK(!store->resumable("P1")->has_value());
}

TEST_CASE("synthetic rows are labelled in every table, and nobody is both") {
  const TemporaryFolder folder;
  auto store = Store::open(folder.path / "a.sqlite", StoreAccess::create);
  REQUIRE(store);
  const std::string real = example_session(*store, "P1", 1, 1),
                    made = example_session(*store, "S1", 2, 1, true);
  for (const auto& [session, synthetic] : {std::pair(real, false), std::pair(made, true)}) {
    CHECK(store->steps_of(session)->front().synthetic == synthetic);
    CHECK(store->answers_of(session)->front().synthetic == synthetic);
    REQUIRE(store->add_event({session, "pause", 0, "", 1, 0, false}));
    CHECK(store->events_of(session)->front().synthetic == synthetic);
  }
  NewSession wrong = example_person("P1", 1);
  wrong.synthetic = true;
  CHECK(!store->begin_session(wrong));
  for (const std::string name : {"Ada Lovelace", "", "a/b", "../x"})
    CHECK(!store->begin_session(example_person(name, 9)));
}

TEST_CASE("a second writer is refused by a message that says which process writes; readers are not") {
  const TemporaryFolder folder;
  auto store = Store::open(folder.path / "a.sqlite", StoreAccess::create);
  REQUIRE(store);
  example_session(*store, "P1", 1, 1);
  const auto second = Store::open(folder.path / "a.sqlite", StoreAccess::write);
  REQUIRE(!second);
  const std::string process = std::to_string(::getpid());  // Not in a name
  CHECK(second.error().what.starts_with("process " + process + " on "));
  CHECK(second.error().what.find("has it open for writing") != std::string::npos);
  const auto reader = Store::open(folder.path / "a.sqlite", StoreAccess::read);
  REQUIRE(reader);
  CHECK(reader->sessions()->size() == 1);
}

TEST_CASE("a clock that is set back is noted, and the order of answers is kept") {
  const TemporaryFolder folder;
  std::int64_t wall = 1'800'000'000'000;
  StoreOptions options;
  options.wall_ms = [&] { return wall; };
  auto store = Store::open(folder.path / "a.sqlite", StoreAccess::create, options);
  REQUIRE(store);
  const std::string session = example_session(*store, "P1", 1, 1);
  REQUIRE(store->begin_step(example_step(session, 1)));
  REQUIRE(store->answer({.session = session, .step = 1, .item = "first", .value = "1"}));
  wall -= 86'400'000;
  REQUIRE(store->answer({.session = session, .step = 1, .item = "second", .value = "2"}));
  const auto notices = store->take_notices();
  REQUIRE(notices.size() == 1);
  CHECK(notices[0] ==
        "this machine's clock was set back from 2027-01-15T08:00:00Z to 2027-01-14T08:00:00Z; "
        "nothing is lost, the order of rows is kept");
  CHECK(store->events_of(session)->back().kind == "clock_set_back");
  CHECK(store->answers_of(session)->back().item == "second");
}

TEST_CASE("files that are no stores are refused in one line, and are not changed") {
  const TemporaryFolder folder;
  const auto message = [&](const char* name, StoreAccess access = StoreAccess::write) {
    const auto store = Store::open(folder.path / name, access);
    return store ? std::string("opened") : store.error().what;
  };
  std::ofstream(folder.path / "text.sqlite") << std::string(5000, 'x');
  const auto before = hash_file(folder.path / "text.sqlite");
  CHECK(message("text.sqlite") == "this is not a study store (no SQLite database)");
  CHECK(message("text.sqlite", StoreAccess::create) == "this is not a study store (no SQLite database)");
  CHECK(hash_file(folder.path / "text.sqlite")->sha256 == before->sha256);
  CHECK(message("none.sqlite") == "no such file");
  CHECK(message("wrong.txt", StoreAccess::create) == "a study store has another name");
  std::ofstream(folder.path / "empty.sqlite").flush();
  CHECK(message("empty.sqlite") == "this is an empty file, not a study store");
  {
    auto other = Database::open(folder.path / "other.sqlite", Database::Access::create);
    REQUIRE(other);
    REQUIRE(other->run("CREATE TABLE t(x)"));
  }
  const auto others = hash_file(folder.path / "other.sqlite");
  CHECK(message("other.sqlite") == "this is not a study store, but another program's database");
  CHECK(hash_file(folder.path / "other.sqlite")->sha256 == others->sha256);
  {
    auto store = Store::open(folder.path / "newer.sqlite", StoreAccess::create);
    REQUIRE(store);
    REQUIRE(store->database().run("PRAGMA user_version = 7"));
  }
  CHECK(message("newer.sqlite") == "a newer Intaglio made it: its schema is 7, this one knows 1");
}

TEST_CASE("a damaged store is refused, not half read") {
  const TemporaryFolder folder;
  const auto path = folder.path / "a.sqlite";
  {
    auto store = Store::open(path, StoreAccess::create);
    REQUIRE(store);
    for (int k = 0; k < 6; ++k) example_session(*store, "P" + std::to_string(k), k, 4);
  }
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(3 * 4096);
  file << std::string(4 * 4096, '\x5a');
  file.close();
  const auto store = Store::open(path, StoreAccess::write);
  REQUIRE(!store);
  CHECK(store.error().what == "the file is damaged");
}

TEST_CASE("a store of which the tables were never made is made anew") {
  const TemporaryFolder folder;
  std::ofstream(folder.path / "a.sqlite").flush();
  auto store = Store::open(folder.path / "a.sqlite", StoreAccess::create);
  REQUIRE(store);
  example_session(*store, "P1", 1, 1);
}

TEST_CASE("refusals are a count") {
  const TemporaryFolder folder;
  auto store = Store::open(folder.path / "a.sqlite", StoreAccess::create);
  REQUIRE(store);
  for (int k = 0; k < 3; ++k) REQUIRE(store->count_refusal("hash"));
  CHECK(store->refusals() == 3);
  CHECK(store->database().count("SELECT count(*) FROM participants") == 0);
}

// In a process of its own, in which no file may grow beyond some bytes: as on a full disk.
TEST_CASE("a full disk is one message, and every acknowledged answer is there afterwards") {
  const TemporaryFolder folder;
  const auto path = folder.path / "a.sqlite";
  std::string session;
  {
    auto store = Store::open(path, StoreAccess::create);
    REQUIRE(store);
    session = example_session(*store, "P1", 1, 1);
    REQUIRE(store->begin_step(example_step(session, 1)));
  }
  int pipe_ends[2];
  REQUIRE(::pipe(pipe_ends) == 0);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{400'000, 400'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    auto store = Store::open(path, StoreAccess::write);
    int acknowledged = 0;
    while (store) {
      const auto done = store->answer({.session = session,
                                       .step = 1,
                                       .item = "item" + std::to_string(acknowledged),
                                       .value = std::string(3000, 'v')});
      if (!done) {
        const std::string said = std::to_string(acknowledged) + " " + done.error().what;
        (void)!::write(pipe_ends[1], said.data(), said.size());
        break;
      }
      ++acknowledged;
    }
    ::_exit(0);
  }
  ::close(pipe_ends[1]);
  std::string said(1000, '\0');
  said.resize(std::size_t(std::max<ssize_t>(0, ::read(pipe_ends[0], said.data(), said.size()))));
  ::close(pipe_ends[0]);
  ::waitpid(child, nullptr, 0);
  INFO(said);
  const int acknowledged = std::atoi(said.c_str());
  CHECK(acknowledged > 10);
  CHECK(said.find("all that was acknowledged before is stored") != std::string::npos);
  auto store = Store::open(path, StoreAccess::write);
  REQUIRE(store);
  const auto answers = store->answers_of(session);
  REQUIRE(answers);
  CHECK(int(answers->size()) == acknowledged + 2);  // two of the first step
}
