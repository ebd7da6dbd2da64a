// SPDX-License-Identifier: BSD-3-Clause
// Taking our place among ODE's geom classes once, and noticing when ODE has forgotten it.
#pragma once

namespace otg {

/// Makes sure that the class is registered with the ODE that is initialised now. Returns a status.
int ensureRegistered() noexcept;

/// dGPUTRIMESH_OK if ODE is initialised and has our precision; registers nothing.
int checkOde() noexcept;

/// dCheckConfiguration, or a test's stand-in for it.
using ConfigurationCheck = int (*)(const char* token);

/// dGPUTRIMESH_OK if the ODE that `check` speaks for has the dReal that this library was compiled with.
int precisionStatus(ConfigurationCheck check) noexcept;

/// Does what the environment variable OTG_BACKEND says, if it is set (backend_api.cpp).
void chooseBackendOfEnvironment() noexcept;

}  // namespace otg
