// A haptic device at the other end of a VRPN link: the tracker, buttons and force device of one name, for
// example Phantom0@host.
//
// read(), write() and the other members of Device are real-time: they swap latest values with a thread of the
// device's own, which dials, pings, redials a second after a loss, and owns the socket; a force leaves within
// 0.5 ms. One servo thread may use them. The destructor returns within 50 ms, whatever that thread is
// doing (see resolve_unless()).
//
// A lost link reads NaN and silent_for() = infinity, so that a guard goes to zero; a device that is silent
// for `silence` counts as lost. When writes stop for that long, the remote device is told to release the
// force.
#pragma once

#include <atomic>
#include <mutex>
#include <thread>

#include "haptics/device.h"
#include "haptics/vrpn/device_link.h"

namespace intaglio::haptics::vrpn {

class VrpnDevice : public Device {
 public:
  explicit VrpnDevice(const Address& address, const VrpnDeviceOptions& options = {});
  ~VrpnDevice() override;

  Vec3 read() override { return link_.read(SteadyTime::clock::now()); }
  void write(const GuardedForce& force) override { link_.write(force.newtons(), SteadyTime::clock::now()); }
  bool reads_orientation() const override { return true; }
  Quat orientation() override { return link_.orientation(); }
  double silent_for() const override { return link_.silent_for(SteadyTime::clock::now()); }

  // Bit k: button k is pressed.
  std::uint32_t buttons() const { return link_.buttons(); }

  // Waits for the first pose; false if that takes longer than `patience`. Not real-time.
  bool wait_for_link(std::chrono::milliseconds patience) const;
  // Why there is no link; while there is one, why there was none before.
  LinkError last_failure() const;

 private:
  void run();
  void serve(Client& client);
  void record_failure(const LinkError& failure);

  Address address_;
  VrpnDeviceOptions options_;
  DeviceLink link_;
  std::atomic<bool> stopped_{false};
  mutable std::mutex failure_mutex_;  // never taken by the servo thread
  LinkError failure_;
  std::thread thread_;
};

}  // namespace intaglio::haptics::vrpn
