// A progress bar on a terminal, sparse lines elsewhere, nothing when quiet. Written to standard error.
#pragma once

#include <chrono>
#include <string>

namespace intaglio {

class Progress {
 public:
  Progress(std::string what, bool quiet);
  ~Progress();
  // `fraction` of the work is done, 0..1; `detail` is shown behind the bar. Cheap: draws a few times a
  // second.
  void update(double fraction, const std::string& detail);

 private:
  void draw(double fraction, const std::string& detail);

  std::string what_;
  bool quiet_, terminal_;
  double last_fraction_ = -1;
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace intaglio
