// Text as JSON writes it.
#pragma once

#include <string>
#include <string_view>

namespace intaglio {

// In quotes; quotes, backslashes and control characters escaped. What is not UTF-8 is not looked at.
std::string json_quoted(std::string_view text);

}  // namespace intaglio
