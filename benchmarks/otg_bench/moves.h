// SPDX-License-Identifier: BSD-3-Clause
// The table `sent` of `otg bench build`.
#pragma once

#include "otg_bench/scene.h"

namespace otg::cli {

/// What the next query on an OpenCL device sends, and how long it takes, after some vertices of a mesh that is there
/// have moved. Nothing where no device can be used.
Json sentRows(const BenchOptions& options);

}  // namespace otg::cli
