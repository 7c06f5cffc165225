// The two sides of a VRPN device: poses from the link to the servo loop, forces from the servo loop to the
// link. A state machine that is given messages and the time.
//
// read(), write() and their neighbours are real-time and belong to one servo thread; begin(), handle(),
// forward() and end() belong to one link thread. When writes stop for `silence`, the remote device is
// asked to release the force.
#pragma once

#include <atomic>
#include <limits>

#include "core/lock_free.h"
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
  PlaneUnits units;              // as the remote driver expects them
  std::int32_t sensor = 0;
  double silence = 0.040;  // s
  ClientOptions client;    // `stopped` is set by the device
};

class DeviceLink {
 public:
  explicit DeviceLink(const VrpnDeviceOptions& options) : options_(options) {}

  // The newest position; NaN while there has been none for `silence`.
  Vec3 read(SteadyTime now);
  Quat orientation() { return heard_.fetch().orientation; }
  void write(const Vec3& newtons, SteadyTime now);
  double silent_for(SteadyTime now) const;  // s; infinity without a link
  // Bit k: button k is pressed.
  std::uint32_t buttons() const { return buttons_.load(std::memory_order_relaxed); }

  // A new link; a force written before is out of date.
  void begin();
  bool handle(const Received& received, SteadyTime now);
  // Sends what was written, or releases what is out of date.
  void forward(Client& client, SteadyTime now);
  void end(Client& client);

 private:
  struct Heard {
    Vec3 position = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    Quat orientation = Quat::Identity();
  };
  struct Wanted {
    Vec3 force = Vec3::Zero(), tip = Vec3::Zero();
    SteadyTime time;
  };

  void display(Client& client, const Wanted& wanted);
  void release(Client& client);

  VrpnDeviceOptions options_;
  Latest<Heard> heard_;
  Latest<Wanted> wanted_;
  Vec3 last_tip_ = Vec3::Zero();                  // servo thread
  SteadyTime forwarded_;                          // link thread: time of the last force sent
  bool holding_ = false, plane_started_ = false;  // link thread: the remote device displays our force
  std::atomic<SteadyTime::rep> heard_at_{-1};     // since the clock's epoch; negative: no link
  std::atomic<std::uint32_t> buttons_{0};
};

}  // namespace intaglio::haptics::vrpn
