// SPDX-License-Identifier: BSD-3-Clause
// Whether two bodies of a pair overlap after one of them is moved: what certificates are checked with.
#pragma once

#include <memory>

#include "truth/pair_body.h"

namespace otg::truth {

/// `grain` is a length much smaller than the overlap. One body at most has a shape.
std::unique_ptr<PairOracle> makeOracle(const PairBody& a, const PairBody& b, double grain);

}  // namespace otg::truth
