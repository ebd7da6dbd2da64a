// SPDX-License-Identifier: BSD-3-Clause
// From the device's clock to the times of stages.
#pragma once

#include "opencl/runtime/launch.h"
#include "opencl/stage_times.h"

namespace otg::opencl {

/// Adds what the device took; call it when the profile is collected.
inline void addTimes(StageTimes& times, const Profile& profile) {
  times.write += profile.ms(Profile::kWrite);
  times.top += profile.ms(Profile::kTop);
  times.levels += profile.ms(Profile::kLevels);
  times.main += profile.ms(Profile::kMain);
  times.contacts += profile.ms(Profile::kContacts);
  times.regions += profile.ms(Profile::kRegions);
  times.select += profile.ms(Profile::kSelect);
  times.choose += profile.ms(Profile::kChoose);
  times.weigh += profile.ms(Profile::kWeigh);
  times.ways += profile.ms(Profile::kWays);
  times.candidates += profile.ms(Profile::kCandidates);
  times.readBack += profile.ms(Profile::kReadBack);
}

}  // namespace otg::opencl
