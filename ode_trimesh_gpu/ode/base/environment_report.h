// SPDX-License-Identifier: BSD-3-Clause
// What the environment says wrong, on stderr.
#pragma once

namespace otg {

/// One line for each value of an environment variable that is not allowed, of equal ones only the first in a process.
/// From any thread.
void reportEnvironment() noexcept;

}  // namespace otg
