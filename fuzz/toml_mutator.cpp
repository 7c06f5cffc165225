// Mutations of TOML line by line, beside libFuzzer's own: lines are copied, moved, removed and repeated, keys
// change tables, and values change type. The result is mostly TOML, so that readers get to see it.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

constexpr std::array<const char*, 26> values = {"0",
                                                "1",
                                                "-1",
                                                "0.5",
                                                "1e-9",
                                                "1e308",
                                                "-0.0",
                                                "nan",
                                                "inf",
                                                "9223372036854775807",
                                                "true",
                                                "false",
                                                "\"\"",
                                                "\"steel\"",
                                                "\"relief\"",
                                                "\"../a.png\"",
                                                "[]",
                                                "[0, 0, 0]",
                                                "[1, 2]",
                                                "[[0, 1], [1, 0]]",
                                                "[1e308, -1e308, nan]",
                                                "{}",
                                                "{ name = \"steel\" }",
                                                "{ file = \"a.obj\" }",
                                                "1979-05-27",
                                                "\"\"\"\n\"\"\""};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> lines(1);
  for (const char c : text)
    if (c == '\n')
      lines.emplace_back();
    else
      lines.back() += c;
  return lines;
}

class Mutation {
 public:
  Mutation(const std::string& text, unsigned seed) : lines_(split(text)), random_(seed) {}

  std::string apply() {
    std::string& line = any();
    const std::string other = any();
    const auto place = lines_.begin() + std::ptrdiff_t(below(lines_.size() + 1));
    switch (below(7)) {
      case 0:
        lines_.insert(place, other);
        break;
      case 1:
        lines_.erase(lines_.begin() + std::ptrdiff_t(below(lines_.size())));
        break;
      case 2:
        std::swap(line, any());
        break;
      case 3:  // another value
        line = key_of(line) + " = " + values[below(values.size())];
        break;
      case 4:  // another line's value
        line = key_of(line) + other.substr(std::min(other.find('='), other.size()));
        break;
      case 5:  // a table, or one of an array of tables
        lines_.insert(place, below(2) == 0 ? "[" + key_of(other) + "]" : "[[" + key_of(other) + "]]");
        break;
      default:  // many of them: arrays of tables grow long
        lines_.insert(place, std::size_t{1} << below(12), other);
        break;
    }
    std::string text;
    for (const std::string& each : lines_) text += each + "\n";
    if (!text.empty()) text.pop_back();
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return random_() % std::max<std::size_t>(n, 1); }
  std::string& any() { return lines_[below(lines_.size())]; }
  // The key of a line, or the name of a table.
  static std::string key_of(const std::string& line) {
    std::string key = line.substr(0, line.find('='));
    std::erase_if(key, [](char c) { return c == '[' || c == ']' || c == ' '; });
    return key;
  }

  std::vector<std::string> lines_;
  std::minstd_rand random_;
};

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  if (size == 0 || seed % 2 == 0) return LLVMFuzzerMutate(data, size, max_size);
  const std::string text = Mutation({reinterpret_cast<const char*>(data), size}, seed).apply();
  const std::size_t length = std::min(text.size(), max_size);
  std::memcpy(data, text.data(), length);
  return length;
}
