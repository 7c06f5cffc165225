#include "core/progress.h"
#include "core/text.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace intaglio {

using std::chrono::duration;
using std::chrono::steady_clock;

Progress::Progress(std::string what, bool quiet)
    : what_(std::move(what)),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(steady_clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (!quiet_ && terminal_ && last_fraction_ >= 0) print_error("\n");
}

void Progress::update(double fraction, const std::string& detail) {
  if (quiet_) return;
  const auto now = steady_clock::now();
  const bool first_or_last = last_fraction_ < 0 || fraction >= 1;
  const bool due = terminal_ ? duration<double>(now - last_).count() > 0.1 : fraction - last_fraction_ >= 0.1;
  if (!first_or_last && !due) return;
  last_ = now;
  last_fraction_ = fraction;
  draw(std::clamp(fraction, 0.0, 1.0), detail);
}

void Progress::draw(double fraction, const std::string& detail) {
  const double elapsed = duration<double>(steady_clock::now() - start_).count();
  const std::string left = fraction > 0.02 && fraction < 1
                               ? fmt::format("{:.0f} s left", elapsed / fraction * (1 - fraction))
                               : fmt::format("{:.0f} s", elapsed);
  constexpr int width = 28;
  const int full = int(fraction * width + 0.5);
  const std::string line =
      fmt::format("{} [{}{}] {:3.0f} %  {}  {}", what_, std::string(std::size_t(full), '#'),
                  std::string(std::size_t(width - full), '.'), 100 * fraction, left, detail);
  print_error(fmt::format("{}{}{}", terminal_ ? "\r" : "", line, terminal_ ? "\x1b[K" : "\n"));
  std::fflush(stderr);
}

}  // namespace intaglio
