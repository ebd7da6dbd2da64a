// SPDX-License-Identifier: BSD-3-Clause
// A pose as the command line takes it.
#pragma once

#include <string>

#include "shared/math/vec3.h"

namespace otg::cli {

/// `text` is "tx,ty,tz,qw,qx,qy,qz" (unit quaternion, normalised once more in double), or the path of a file with a 4x4
/// row-major matrix: 16 numbers as plain text or as a JSON array (flat or nested), used as given. "FILE#NAME" takes the
/// member NAME of a JSON object, or its member "T".
/// Throws UsageError for text that is neither, InputError for a file or numbers that do not make a pose.
Transformd parsePose(const std::string& text);

/// `values`: 16 numbers, row-major. Throws InputError, which starts with `source`. Its rotation may be off by
/// kRotationTolerance (a warning on stderr says so).
Transformd poseFromMatrix(const double* values, const std::string& source);

}  // namespace otg::cli
