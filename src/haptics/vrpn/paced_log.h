// A log that strangers cannot flood: ten lines in ten seconds, then the number of the others.
#pragma once

#include <functional>
#include <string>

#include "haptics/vrpn/connection.h"

namespace intaglio::haptics::vrpn {

class PacedLog {
 public:
  static constexpr int lines_at_once = 10;
  static constexpr std::chrono::seconds period{10};

  explicit PacedLog(std::function<void(const std::string&)> write) : write_(std::move(write)) {}

  void line(SteadyTime now, const std::string& text) {
    step(now);
    if (lines_ == 0) begun_ = now;
    if (++lines_ <= lines_at_once) write_(text);
  }
  // Writes "... and 312 more in the last 10 s" once the period that the first line began is over.
  void step(SteadyTime now) {
    if (lines_ == 0 || now - begun_ < period) return;
    const int more = lines_ - lines_at_once;
    if (more > 0)
      write_("... and " + std::to_string(more) + " more in the last " + std::to_string(period.count()) +
             " s");
    lines_ = 0;
  }

 private:
  std::function<void(const std::string&)> write_;
  SteadyTime begun_;
  int lines_ = 0;  // written in this period
};

}  // namespace intaglio::haptics::vrpn
