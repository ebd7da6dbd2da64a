// SPDX-License-Identifier: BSD-3-Clause
// A moving scene as one binary glTF file, for any viewer.
#pragma once

#include <string>

#include "scenes/recording.h"

namespace otg::scenes {

/// z is up in our worlds and y in glTF: the root node turns the scene. Bodies with the same surface share it in the
/// file. A camera looks at the stage, two lights shine on it (KHR_lights_punctual), and each contact is an arrow whose
/// colour shows its depth. Throws std::runtime_error if the file cannot be written.
void writeGlb(const std::string& path, const Recording& recording);

}  // namespace otg::scenes
