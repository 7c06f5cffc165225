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

#include "core/lock_free.h"
#include "haptics/device.h"
#include "haptics/vrpn/client.h"
#include "haptics/vrpn/force.h"

namespace intaglio::haptics::vrpn {

// How a force is sent to the remote driver.
enum class ForceMode {
  field,  // a force field about the tip at each write: PHANToM and Falcon drivers
  plane,  // a plane that gives this force here and holds between writes: the paper's way, for slow links
  force,  // the force itself: Intaglio's own server
};

struct VrpnDeviceOptions {
  ForceMode force_mode = ForceMode::field;
  double plane_stiffness = 800;  // N/m
  double plane_damping = 1;      // N s/m
  PlaneUnits units;              // of the remote driver
  std::int32_t sensor = 0;
  double silence = 0.040;  // s
  ClientOptions client;    // `stopped` is set by the device
};

class VrpnDevice : public Device {
 public:
  explicit VrpnDevice(const Address& address, const VrpnDeviceOptions& options = {});
  ~VrpnDevice() override;

  Vec3 read() override;
  void write(const GuardedForce& force) override;
  bool reads_orientation() const override { return true; }
  Quat orientation() override { return heard_.fetch().orientation; }
  double silent_for() const override;

  // Bit k: button k is pressed.
  std::uint32_t buttons() const { return buttons_.load(std::memory_order_relaxed); }

  // Waits for the first pose; false if that takes longer than `patience`. Not real-time.
  bool wait_for_link(std::chrono::milliseconds patience) const;
  // Why there is no link; while there is one, why there was none before.
  LinkError last_failure() const;

 private:
  struct Heard {
    Vec3 position = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    Quat orientation = Quat::Identity();
  };
  struct Wanted {
    Vec3 force = Vec3::Zero(), tip = Vec3::Zero();
    std::int64_t time = 0;  // ns, steady clock
  };

  void run();
  void serve(Client& client);
  bool handle(const Received& received);
  void forward(Client& client);
  void display(Client& client, const Wanted& wanted);
  void release(Client& client);
  void record_failure(const LinkError& failure);

  Address address_;
  VrpnDeviceOptions options_;
  Latest<Heard> heard_;
  Latest<Wanted> wanted_;
  Vec3 last_tip_ = Vec3::Zero();                  // servo thread
  std::int64_t forwarded_ = 0;                    // link thread: time of the last force sent
  bool holding_ = false, plane_started_ = false;  // link thread: the remote device displays our force
  std::atomic<std::int64_t> heard_at_{-1};        // ns, steady clock; negative: no link
  std::atomic<std::uint32_t> buttons_{0};
  std::atomic<bool> stopped_{false};
  mutable std::mutex failure_mutex_;  // never taken by the servo thread
  LinkError failure_;
  std::thread thread_;
};

}  // namespace intaglio::haptics::vrpn
