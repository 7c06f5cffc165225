// Withdrawal: removes a participant from a store, rows and high-rate files alike. Deleted content is
// overwritten in the database (secure_delete), its log truncated and the file compacted (VACUUM); files are
// unlinked, which on flash memory overwrites nothing. A hash of the id stays, so that the id is not
// used again. A withdrawal that is killed half way is finished when the store is opened or when it is
// repeated.
#pragma once

#include <string>
#include <vector>

#include "intaglio/error.h"
#include "study/store/rows.h"
#include "study/store/store.h"

namespace intaglio::study {

struct Withdrawal {
  std::int64_t sessions = 0, files = 0;
  std::vector<ExportRow> exports;  // made before, which contain the participant
};

// Errors: no such participant, the store cannot be compacted because another program reads it.
Result<Withdrawal> withdraw(Store& store, const std::string& participant);

}  // namespace intaglio::study
