// SPDX-License-Identifier: BSD-3-Clause
// A recording as a page that plays it in any browser: from the disk, without a server and without a network.
#pragma once

#include <string>

#include "scenes/recording.h"

namespace otg::scenes {

/// Writes one file: the viewer of harness/viewer/, three.js, and the recording as JSON whose arrays are base64 of small
/// little-endian numbers. `title` is shown. Throws std::runtime_error if the file cannot be written, or if the program
/// was built without three.js.
void writeHtmlPage(const std::string& path, const std::string& title, const Recording& recording);

/// The page without a recording, in pieces, with a null pointer behind the last. Empty without three.js.
extern const char* const kPageParts[];

}  // namespace otg::scenes
