#include "haptics/vrpn/vrpn_device.h"

namespace intaglio::haptics::vrpn {

namespace {

constexpr std::chrono::microseconds link_period{500};
constexpr std::chrono::milliseconds redial_period{1000};

}  // namespace

VrpnDevice::VrpnDevice(const Address& address, const VrpnDeviceOptions& options)
    : address_(address), options_(options), link_(options) {
  options_.client.stopped = &stopped_;
  thread_ = std::thread([this] { run(); });
}

VrpnDevice::~VrpnDevice() {
  stopped_ = true;
  thread_.join();
}

bool VrpnDevice::wait_for_link(std::chrono::milliseconds patience) const {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!(silent_for() <= options_.silence)) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

LinkError VrpnDevice::last_failure() const {
  const std::lock_guard lock(failure_mutex_);
  return failure_;
}

void VrpnDevice::record_failure(const LinkError& failure) {
  const std::lock_guard lock(failure_mutex_);
  failure_ = failure;
}

void VrpnDevice::run() {
  while (!stopped_) {
    auto client = Client::connect(address_, options_.client);
    if (client) {
      serve(**client);
      record_failure({(*client)->fault(), {address_.text(), std::string(describe((*client)->fault())), ""}});
    } else {
      record_failure(client.error());
    }
    const auto redial = std::chrono::steady_clock::now() + redial_period;
    while (!stopped_ && std::chrono::steady_clock::now() < redial)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void VrpnDevice::serve(Client& client) {
  link_.begin();
  while (!stopped_ && client.fault() == LinkFault::none) {
    client.step(link_period, [this](const Received& received) {
      return link_.handle(received, SteadyTime::clock::now());
    });
    link_.forward(client, SteadyTime::clock::now());
  }
  link_.end(client);
  client.step({}, [](const Received&) { return true; });
}

}  // namespace intaglio::haptics::vrpn
