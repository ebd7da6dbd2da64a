// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/batch/routing.h"

namespace otg::opencl {

Fate fateBefore(const PairBefore& pair) {
  if (pair.refused) return Fate::kRefused;
  if (pair.large) return Fate::kAlone;
  return pair.idle || pair.host ? Fate::kWithoutDevice : Fate::kDevice;
}

Fate fateAfter(otg_uint flags, const BatchRules& rules, bool doneMeanwhile) {
  if (flags & OTG_PAIR_REFUSED) return Fate::kRefused;
  if (flags & OTG_PAIR_NO_FRAME) return Fate::kWithoutDevice;
  if (flags & OTG_PAIR_SKIPPED) return Fate::kSettled;
  const bool isLeft = (flags & OTG_PAIR_TO_HOST) && !(flags & OTG_PAIR_INTERSECTS);
  if (!isLeft && !rules.recordsOfAll) return Fate::kDevice;
  if (doneMeanwhile) return Fate::kMeanwhile;
  return rules.describes && mayBeDescribed(flags) ? Fate::kDescribed : Fate::kRecords;
}

Fate fateAfterFailure(bool refused, bool doneMeanwhile) {
  if (refused) return Fate::kRefused;
  return doneMeanwhile ? Fate::kMeanwhile : Fate::kWithoutDevice;
}

bool mayBeDescribed(otg_uint flags) {
  const otg_uint why = flags >> OTG_PAIR_WHY;
  if (why & (OTG_SOLID_INEXACT | OTG_SOLID_CONTAINED | OTG_SOLID_TIE)) return false;
  return (why & OTG_SOLID_AT_ODDS) || ((why & OTG_SOLID_BY_CELLS) && !(why & OTG_SOLID_BROKEN));
}

}  // namespace otg::opencl
