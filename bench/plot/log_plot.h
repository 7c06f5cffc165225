// A page of plots with logarithmic axes, as one SVG file that needs nothing else.
#pragma once

#include <string>
#include <vector>

#include "intaglio/error.h"

namespace intaglio::bench {

struct Series {
  std::string name;
  std::vector<double> xs, ys;  // ascending in x; values that are not positive are left out
};

struct Panel {
  std::string title, x_label, y_label;
  std::vector<Series> series;
  double limit = 0;  // a dashed line at this y; 0: none
  std::string limit_name = {};
  double mark = 0;  // likewise at this x
  std::string mark_name = {};
};

// Panels side by side, three in a row. A series has the same colour in all of them, and the key below the
// panels names it. Errors: the file cannot be written.
Result<void> write_log_plot(const std::string& file, const std::string& title,
                            const std::vector<Panel>& panels);

}  // namespace intaglio::bench
