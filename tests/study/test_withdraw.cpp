// Withdrawal leaves nothing of a person in any file, and everything of the others.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "study/store/store.h"
#include "study/store/withdraw.h"
#include "tests/study/example_study.h"
#include "tests/temporary_folder.h"

using namespace intaglio;
using namespace intaglio::study;
using namespace intaglio::tests;

namespace {

// How many files below a folder hold a text.
int files_with(const std::filesystem::path& folder, const std::string& text) {
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    if (bytes.find(text) != std::string::npos ||
        entry.path().filename().string().find(text) != std::string::npos)
      ++count;
  }
  return count;
}

}  // namespace

TEST_CASE("after a withdrawal no file has a byte of the person, and the others are complete") {
  const TemporaryFolder folder;
  auto store = Store::open(folder.path / "a.sqlite", StoreAccess::create);
  REQUIRE(store);
  const std::string kept = example_session(*store, "KEPTPERSON", 1, 3);
  const std::string gone = example_session(*store, "GONEPERSON", 2, 3);
  REQUIRE(store->begin_step(example_step(gone, 3)));
  REQUIRE(store->answer({.session = gone, .step = 3, .item = "free", .value = "SECRETWORDS", .seconds = 1}));
  REQUIRE(store->add_event({gone, "note", 3, "SECRETNOTE", 1, 0, false}));
  StreamHeader header;
  header.name = "pose";
  header.session = gone;
  header.step = 3;
  header.columns = {{"time", "s", "LATENCY", "n/a", "n/a"}};
  REQUIRE(store->open_stream(header));
  REQUIRE(store->finish_step(gone, 3, 40, {4, 40, "SECRETSTATE", ""}));
  REQUIRE(store->add_export("csv", "out/csv", {"KEPTPERSON", "GONEPERSON"}));
  for (const std::string& text : {std::string("SECRETWORDS"), std::string("SECRETSTATE"), gone})
    REQUIRE(files_with(folder.path, text) > 0);
  const auto done = withdraw(*store, "GONEPERSON");
  REQUIRE(done);
  CHECK(done->sessions == 1);
  CHECK(done->files == 1);
  REQUIRE(done->exports.size() == 1);
  CHECK(done->exports[0].target == "out/csv");
  for (const std::string& text : {std::string("SECRETWORDS"), std::string("SECRETNOTE"),
                                  std::string("SECRETSTATE"), std::string("GONEPERSON"), gone}) {
    INFO(text);
    CHECK(files_with(folder.path, text) == 0);
  }
  CHECK(files_with(folder.path, "KEPTPERSON") > 0);
  CHECK(store->answers_of(kept)->size() == 6);
  const auto again = store->begin_session(example_person("GONEPERSON", 2));
  REQUIRE(!again);
  CHECK(again.error().what == "has withdrawn from this study");
  CHECK(!withdraw(*store, "NOBODY"));
}
