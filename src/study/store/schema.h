// The tables of a study store (docs/study-store.md), and the rules for opening one: which file is a store,
// and of which version.
#pragma once

#include <string_view>

#include "intaglio/error.h"
#include "study/store/database.h"

namespace intaglio::study {

inline constexpr std::int64_t store_schema_version = 1;

// Creates the tables in an empty file, in one transaction. `store_id` is the name of the store from then on.
Result<void> create_schema(Database& database, const std::string& store_id);
// Errors: another program's database, a newer schema (with both versions).
Result<void> check_schema(const Database& database);
// An empty file, as a process leaves it that is killed before its tables are made.
Result<bool> is_empty_database(const Database& database);

// Tables whose rows belong to one session, in the order in which they can be filled.
inline constexpr std::string_view session_tables[] = {"steps",   "conditions",  "answers", "events",
                                                      "quality", "checkpoints", "streams"};

}  // namespace intaglio::study
