// SPDX-License-Identifier: BSD-3-Clause
// How far contacts are from the truth, and what many such errors amount to.
#pragma once

#include <span>
#include <vector>

#include "collide/query.h"
#include "truth/overlap_volume.h"
#include "truth/separation.h"

namespace otg::truth {

/// Any library's contact, in A's frame; moving A along the normal (unit) by the depth separates.
struct PlainContact {
  Vec3d position, normal;
  double depth = 0;
};
std::vector<PlainContact> plain(std::span<const Contact> contacts);

/// What contacts do to A together when each pushes as much as it is deep.
struct Wrench {
  Vec3d force{0, 0, 0};   ///< sum of depth n
  Vec3d moment{0, 0, 0};  ///< sum of depth (p - about) x n
};
Wrench wrenchOf(std::span<const PlainContact> contacts, const Vec3d& about);

/// Angle between two vectors in degrees, 0 to 180; 180 if one of them vanishes.
double angleBetween(const Vec3d& a, const Vec3d& b);
/// Distance between the lines of action: moment over force, as a length.
double armError(const Wrench& a, const Wrench& b);

/// A sample of errors.
class Errors {
 public:
  void add(double x) { values_.push_back(x); }
  std::size_t count() const { return values_.size(); }
  /// The value that the given part of all is at most (0.5: median); 0 for none.
  double quantile(double part) const;
  double largest() const { return quantile(1); }

 private:
  std::vector<double> values_;
};

}  // namespace otg::truth
