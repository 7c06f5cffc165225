// The command line of a benchmark that runs at several sizes of texture: [--json] [SIZE...].
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <vector>

namespace intaglio::bench {

struct Arguments {
  bool json = false;
  std::vector<int> sizes;  // texels a side
};

// `fallback` when no size is given; nothing, after a line that says why, when the command line is wrong.
inline std::optional<Arguments> arguments(int argc, char** argv, const char* program, int least,
                                          std::vector<int> fallback) {
  Arguments out;
  for (int k = 1; k < argc; ++k) {
    if (std::string_view(argv[k]) == "--json") {
      out.json = true;
    } else if (const int size = std::atoi(argv[k]); size >= least && size <= 16384) {
      out.sizes.push_back(size);
    } else {
      fmt::print(stderr, "{}: '{}' is neither --json nor a size in {}..16384\n", program, argv[k], least);
      return std::nullopt;
    }
  }
  if (out.sizes.empty()) out.sizes = std::move(fallback);
  return out;
}

}  // namespace intaglio::bench
