// SPDX-License-Identifier: BSD-3-Clause
// Members of the families of certificates as worlds: gravity pushes the mover into its host, as bodies settle.
#pragma once

#include <cstdint>

#include "truth/certificate_families.h"

namespace otg::truth {

/// How a mover begins: in its shallow overlap and at rest; out of its host at some distance and at rest; or just out of
/// it and moving across the way in, by one size a second.
enum class FallStart : std::uint8_t { kSettled, kDropped, kSlid };

struct FallConditions {
  FallStart start = FallStart::kSettled;
  double timeStep = 1.0 / 240;  ///< seconds
  bool quick = true;            ///< dWorldQuickStep; else dWorldStep
  double duration = 2;          ///< seconds
  bool asTriMesh = false;       ///< meshes are ODE's dTriMesh
  std::uint32_t seed = 0;       ///< of the direction of gravity and of friction
};

/// Both steppers and two time steps in turn.
FallConditions fallConditions(int number);

/// The same pair with an open host: one that lost all triangles that lie in a side of its bounding box. What is left
/// are inner walls without a body behind them. None if nothing or all of it lies there, or if the host is a shape.
std::optional<CertificateMember> withOpenHost(const CertificateMember& member);

/// What happened to a mover in its host, which is static.
struct Fall {
  double gain = 0;   ///< largest rise of the mover's energy in one step: of its weight times its size
  int step = -1;     ///< the step of it
  double depth = 0;  ///< of the deepest contact, in sizes
};

/// From this gain on the mover was thrown. Pushing an overlap of a hundredth out gains up to 0.015 at 240 steps a
/// second.
constexpr double kThrown = 0.05;
/// The same at any time step. The solver pushes an overlap out within some steps, so that small steps gain more.
double thrownFrom(double timeStep);

/// Gravity is 9.81 sizes per second squared, about along the mover's shortest way in. ODE and the geom class must be
/// initialised, and this thread must have ODE's data. Throws std::runtime_error where the library refuses a mesh.
Fall fall(const CertificateMember& member, const FallConditions& conditions);

}  // namespace otg::truth
