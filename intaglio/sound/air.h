// Air at 20 degrees Celsius.
#pragma once

namespace intaglio::sound {

inline constexpr double air_density = 1.204;     // kg/m^3
inline constexpr double speed_of_sound = 343.2;  // m/s

}  // namespace intaglio::sound
