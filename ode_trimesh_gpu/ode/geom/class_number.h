// SPDX-License-Identifier: BSD-3-Clause
// Our place among ODE's geom classes, and the order of geoms. Who takes that place is class_registration.h.
#pragma once

#include <cstdint>

namespace otg {

/// The class number, or -1 before the first registration. It may be out of date after dCloseODE().
int registeredClass() noexcept;
void setRegisteredClass(int number) noexcept;

/// Numbers for geoms in the order of their creation; see GeomObject::serial.
std::uint64_t nextSerial() noexcept;

/// Called by our collider functions for a geom without an object. Only the probe of ensureRegistered() (and a program
/// that calls dCreateGeom itself) makes such geoms; being called shows the probe that the collider table is still ours.
void answerProbe() noexcept;
/// Whether the calling thread's probe was answered since the last call.
bool takeProbeAnswer() noexcept;

}  // namespace otg
