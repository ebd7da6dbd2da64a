// SPDX-License-Identifier: BSD-3-Clause
// Takes the place of the page where three.js is not installed.
#include "scenes/html_page.h"

namespace otg::scenes {
const char* const kPageParts[] = {nullptr};
}  // namespace otg::scenes
