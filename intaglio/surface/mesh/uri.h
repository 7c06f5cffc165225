// The two uris that a mesh file may use for its bytes: data in base64, and the relative name of a side file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace intaglio::surface {

// The bytes of "data:...;base64,..."; absent when it is not one, or its text is not base64.
std::optional<std::vector<std::uint8_t>> data_uri(std::string_view uri);

// The file name of a relative uri with its %20s decoded; absent for anything that could lead elsewhere:
// schemes, absolute names, "..", backslashes, control characters.
std::optional<std::string> side_file(std::string_view uri);

}  // namespace intaglio::surface
