// The part of a surface that each sense delivered, taken from that sense's own output alone: force, motion
// or samples of sound; never from the surface or from contact events.
//
// Touch gives the direction of the force: shapes are felt by lateral force (Robles-De-La-Torre and Hayward
// 2001). Sight gives slopes, by the light (evaluate/sight.h). Motion gives accelerations. Sound gives when
// it is excited, not how it rings. All are series in time. Pure functions; any thread; allocate.
#pragma once

#include <span>
#include <vector>

#include "intaglio/vec.h"

namespace intaglio::report {

// Positions in the plane of the surface, with the direction of motion at each. Where the probe is at rest,
// the direction is the last one.
struct Path {
  std::vector<Vec2> place, direction;  // m, unit
  std::vector<double> distance;        // m, travelled so far
  std::vector<double> speed;           // m/s
};
// The path of points (m, third coordinate ignored) sampled at `rate` Hz; directions and speed are means over
// `smooth` seconds.
Path path_of(std::span<const Vec3> points, double rate, double smooth);

// Sine of the angle by which the force on the hand leans against the motion: of the slope that is felt, and
// of friction, which adds a constant. Force in N, z out of the surface; 0 where it is less than `least`
// newtons.
std::vector<double> felt_lean(std::span<const Vec3> force, const Path& path, double least = 0.02);

// Acceleration along the path, m/s^2: how a body's motion shows the slopes that it crosses, whether or not
// it is drawn to rise and fall.
std::vector<double> acceleration_along(std::span<const Vec3> acceleration, const Path& path);

// How strongly the sound is excited, at `rate` values a second, the first at time 0: root mean square of
// what linear prediction leaves of the samples. Prediction removes what rings on; a new excitation remains
// (Atal and Hanauer 1971, on speech). The order is 48.
std::vector<double> excitation(std::span<const float> sound, double sample_rate, double rate);

// A Gaussian filter of standard deviation `sigma` values; ends are repeated.
std::vector<double> smoothed(std::span<const double> series, double sigma);

// The value of a series at `position`, in values from its first, linear between values; clamped to its ends.
double value_at(std::span<const double> series, double position);

}  // namespace intaglio::report
