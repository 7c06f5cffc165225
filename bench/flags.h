// The command line of a benchmark with several options: flags that stand alone (--json) and flags with a
// value after them (--plot FILE).
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace intaglio::bench {

class Flags {
 public:
  // Nothing, after a line that says why, if the command line holds anything else or a value is missing.
  static std::optional<Flags> parse(int argc, char** argv, const std::vector<std::string>& alone,
                                    const std::vector<std::string>& with_value = {}) {
    const auto holds = [](const std::vector<std::string>& list, const std::string& name) {
      return std::find(list.begin(), list.end(), name) != list.end();
    };
    Flags out;
    for (int k = 1; k < argc; ++k) {
      const std::string name = argv[k];
      if (holds(alone, name)) {
        out.values_[name] = "";
      } else if (holds(with_value, name) && k + 1 < argc) {
        out.values_[name] = argv[++k];
      } else {
        std::string known;
        for (const std::string& flag : alone) known += fmt::format(" {}", flag);
        for (const std::string& flag : with_value) known += fmt::format(" {} VALUE", flag);
        fmt::print(stderr, "{}: '{}' is none of{}\n", argv[0], name, known);
        return std::nullopt;
      }
    }
    return out;
  }

  bool has(const std::string& name) const { return values_.count(name) > 0; }
  // Empty if the flag is not there.
  std::string value(const std::string& name) const { return has(name) ? values_.at(name) : std::string(); }

 private:
  std::map<std::string, std::string> values_;
};

}  // namespace intaglio::bench
