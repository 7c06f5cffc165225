// An error in what one file's line names (a texture, a device): the line comes first, so that both places are
// said. "a.toml:12: wall.png: no such file".
#pragma once

#include "intaglio/core/error.h"

namespace intaglio {

// `where` is the line; empty: the error as it is.
inline Error with_where(const std::string& where, const Error& error) {
  if (where.empty()) return error;
  return {where, error.where.empty() ? error.what : error.where + ": " + error.what, error.fix};
}

}  // namespace intaglio
