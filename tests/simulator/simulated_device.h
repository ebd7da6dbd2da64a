// SPDX-License-Identifier: BSD-3-Clause
// What tests on a simulated device share.
#pragma once

#include <memory>

#include "support/opencl.h"

namespace otg::test {

/// The sizes of work-groups are those of GPUs; there are fewer of them, since each takes its time.
inline opencl::Tuning simulated() {
  opencl::Tuning tuning;
  tuning.groupsPerUnit = 2;
  tuning.overlapGroupsPerUnit = 2;
  tuning.warmUp = false;
  return tuning;
}

inline std::shared_ptr<opencl::Backend> openSimulated(const opencl::Tuning& tuning) {
  auto backend = openBackend(tuning);
  REQUIRE(backend);
  REQUIRE(backend->device().kind == opencl::DeviceKind::kGpu);
  REQUIRE(backend->device().doubles == tuning.doubles);
  REQUIRE(backend->device().longAtomics);
  return backend;
}

}  // namespace otg::test
