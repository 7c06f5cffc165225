// The version of the library. CMakeLists.txt reads it here.
//
// Until 1.0 a minor version may change what its headers declare (CHANGELOG.md says what); a patch version never does.
// From 1.0 on only a major version may. Shared libraries carry the number of their binary interface in their names.
#pragma once

#define INTAGLIO_VERSION_MAJOR 0
#define INTAGLIO_VERSION_MINOR 1
#define INTAGLIO_VERSION_PATCH 0
// To compare: #if INTAGLIO_VERSION >= 200 is 0.2.0 or newer.
#define INTAGLIO_VERSION (INTAGLIO_VERSION_MAJOR * 10000 + INTAGLIO_VERSION_MINOR * 100 + INTAGLIO_VERSION_PATCH)

namespace intaglio {

// "0.1.0", of the library that is linked, which may be another than that of the headers.
const char* version();

}  // namespace intaglio
