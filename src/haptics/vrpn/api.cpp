#include <chrono>
#include <utility>

#include "haptics/api.h"
#include "haptics/vrpn/vrpn_device.h"
#include "intaglio/vrpn.h"

namespace intaglio {

Result<Device> open_vrpn(const std::string& address, const VrpnOptions& options) {
  namespace vrpn = haptics::vrpn;
  const auto parsed = vrpn::parse_address(address);
  if (!parsed) return tl::unexpected(parsed.error());
  vrpn::VrpnDeviceOptions wanted;
  wanted.force_mode = options.force == VrpnForce::field   ? vrpn::ForceMode::field
                    : options.force == VrpnForce::plane ? vrpn::ForceMode::plane
                                                        : vrpn::ForceMode::force;
  wanted.silence = options.silence;
  wanted.plane_stiffness = options.plane_stiffness;
  wanted.plane_damping = options.plane_damping;
  wanted.units = {options.stiffness_unit, options.damping_unit};
  wanted.sensor = options.sensor;
  auto device = std::make_unique<vrpn::VrpnDevice>(*parsed, wanted);
  if (!device->wait_for_link(std::chrono::milliseconds(std::int64_t(1e3 * options.wait)))) {
    const Error failure = device->last_failure().error;
    return failure.what.empty() ? Result<Device>(fail(address, "does not answer", "start its VRPN server"))
                                : Result<Device>(tl::unexpected(failure));
  }
  auto impl = std::make_shared<Device::Impl>();
  impl->device = std::move(device);
  return Device(std::move(impl));
}

}  // namespace intaglio
