// SPDX-License-Identifier: BSD-3-Clause
// How a nut runs down a bolt without friction, computed without any collider: what the sum of contact model, stepper
// and step is compared with.
//
// The ideal is not the smooth helix. Threads are facetted, so that the nut goes over bumps, and each bump costs energy.
// The reference has two degrees of freedom, the height z and the angle of a nut whose axis stays on the bolt's:
// - for every angle the least height at which no flank of the nut lies in a flank of the bolt, from the triangles
//   themselves: over each pair of an upward triangle of the bolt and a downward triangle of the nut, the largest
//   vertical distance over the common part of their projections (a convex polygon; the distance is linear, so its
//   largest value is at a corner). Meshes whose columns repeat along the helix only need one column's angles;
// - gravity, and impacts that are plastic: on contact the velocity (z', angle') keeps its momentum along the contact
//   and loses the rest, in the metric of mass and inertia. Steps of 10 microseconds.
#pragma once

#include <vector>

#include "scenes/generated_meshes.h"

namespace otg::physics {

struct ThreadSetup {
  scenes::MeshArrays bolt, nut;  ///< axis z; the nut as it starts, clear of the bolt
  double pitch;                  ///< m per turn
  int segments;                  ///< columns per turn of both meshes; if not every column repeats, of those that do
  double inertia;                ///< of the nut about its axis for 1 kg, kg m^2
  double gravity;                ///< m/s^2, downwards
  int samples = 64;              ///< of the height, in each column
};

/// Change of height after so many seconds, m (negative: down), and the turned angle in radians.
struct ThreadMotion {
  double travel, angle;
};
ThreadMotion plasticThreadReference(const ThreadSetup& setup, double seconds);

/// The least heights above the start at which the nut is clear, at `samples` angles from 0 to one column, in m.
std::vector<double> threadHeights(const ThreadSetup& setup, int samples);

}  // namespace otg::physics
