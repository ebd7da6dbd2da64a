// SPDX-License-Identifier: BSD-3-Clause
#include "truth/pair_body.h"

namespace otg::truth {

Transformd relativePose(const Transformd& a, const Transformd& b) {
  Transformd out{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) sum += a.r[3 * k + row] * b.r[3 * k + column];
      out.r[3 * row + column] = sum;
    }
  }
  out.t = otgRotateBack(a, otgSub(b.t, a.t));
  return out;
}

}  // namespace otg::truth
