// SPDX-License-Identifier: BSD-3-Clause
// `otg collide MESH FIELD.json --pose P`: a mesh on a heightfield of ODE's.
#pragma once

#include <string>

#include "cli/query_options.h"

namespace otg::cli {

/// Throws UsageError, InputError, SceneError or LoadError.
int collideWithHeightfield(const QueryOptions& options, int repeat, bool json);

}  // namespace otg::cli
