// SPDX-License-Identifier: BSD-3-Clause
// The judge of a set of contacts: what the set requests separates the bodies, and not by much more than is needed.
#pragma once

#include <optional>
#include <vector>

#include "truth/pair_oracle.h"
#include "truth/shortest_translation.h"

namespace otg::truth {

/// As a program sees it, in world coordinates.
struct JudgedContact {
  Vec3d position, normal;  ///< the normal points out of B, into A
  double depth = 0;
  bool exempt = false;  ///< flagged as contained or clamped: depths of such pairs follow other rules
};

struct Certificate {
  bool none = false;        ///< no contacts
  bool infeasible = false;  ///< no translation satisfies all of them
  Vec3d asked{0, 0, 0};     ///< the shortest translation that satisfies all
  double length = 0;        ///< |asked|
  double leftWay = 1;       ///< after it: the shortest translation that separates, over what it was
  /// Part of the overlap that is left after it: of the volume, or where that is not to be had of the way.
  double left = 1;
};

/// The bodies overlap; `shortest` is the length of the shortest translation that separates them.
Certificate certify(PairOracle& oracle, double shortest, const std::vector<JudgedContact>& contacts);

/// Contacts deeper than three times the distance from their deepest point to the surface that they leave.
///
/// The contact's place is in the middle of the overlap. The deepest point of A is half the depth below it, and that of
/// B half above. The surface to leave are the other body's triangles that face the way out to within 60 degrees:
/// others, such as the side of a block over whose edge a body hangs, may be as near as they like. With them, nearly
/// every resting body has such a contact. Depths up to `grain` are rounding.
std::vector<std::size_t> tooDeep(const PairBody& a, const PairBody& b, const std::vector<JudgedContact>& contacts,
                                 double grain);

/// The number of contacts of either list without a partner in the other. A partner is within `tolerance` in place and
/// depth (lengths) and within `ofNormals` in the normal.
int unmatched(const std::vector<JudgedContact>& x, const std::vector<JudgedContact>& y, double tolerance,
              double ofNormals);

}  // namespace otg::truth
