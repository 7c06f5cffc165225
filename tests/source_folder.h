// Where the project's files are, and real assets outside it, while tests run.
#pragma once

namespace intaglio::tests {

extern const char* const source_folder;
extern const char* const shared_folder;  // may not exist: then tests that want it skip

}  // namespace intaglio::tests
