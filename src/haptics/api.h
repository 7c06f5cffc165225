// What is behind intaglio::Device (include/intaglio/haptics.h), for the libraries that make one.
#pragma once

#include <memory>

#include "haptics/device.h"
#include "intaglio/haptics.h"

namespace intaglio {

struct Device::Impl {
  std::unique_ptr<haptics::Device> device;
  // s between ticks, of the loop that uses the device: a simulated one moves by it.
  std::shared_ptr<double> period = std::make_shared<double>(1e-3);
};

}  // namespace intaglio
