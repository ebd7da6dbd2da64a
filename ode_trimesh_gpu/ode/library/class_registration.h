// SPDX-License-Identifier: BSD-3-Clause
// Our place among ODE's geom classes: taking it once, and noticing when ODE has forgotten it.
#pragma once

#include <cstdint>

namespace otg {

/// The class number, or -1 before the first registration. It may be out of date after dCloseODE().
int registeredClass() noexcept;

/// Makes sure that the class is registered with the ODE that is initialised now. Returns a status.
int ensureRegistered() noexcept;

/// dGPUTRIMESH_OK if ODE is initialised and has our precision; registers nothing.
int checkOde() noexcept;

/// Numbers for geoms in the order of their creation; see GeomObject::serial.
std::uint64_t nextSerial() noexcept;

/// dCheckConfiguration, or a test's stand-in for it.
using ConfigurationCheck = int (*)(const char* token);

/// dGPUTRIMESH_OK if the ODE that `check` speaks for has the dReal that this library was compiled with.
int precisionStatus(ConfigurationCheck check) noexcept;

/// Does what the environment variable OTG_BACKEND says, if it is set (backend_api.cpp).
void chooseBackendOfEnvironment() noexcept;

/// Called by our collider functions for a geom without an object. Only the probe of ensureRegistered() (and a program
/// that calls dCreateGeom itself) makes such geoms; being called tells the probe that the collider table is still ours.
void answerProbe() noexcept;

}  // namespace otg
