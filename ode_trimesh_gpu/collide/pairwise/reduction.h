// SPDX-License-Identifier: BSD-3-Clause
// Choosing few contacts out of many. All functions are deterministic and independent of the order of their input: ties
// are broken by (triangleA, triangleB, feature).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "collide/query.h"

namespace otg {

/// Six-dimensional binning of the published design: positions scaled into the unit cube of their own bounds,
/// normals from [-1, 1] into the unit cube; one contact per bin, the one farthest from the origin of the 6-cube (its
/// centre, so that extreme positions and normals win) stays. Order of the result: by (triangleA, triangleB, feature).
std::vector<Contact> reduceByBinning(std::span<const Contact> contacts, const std::array<int, 6>& bins);

/// Keeps contacts whose wrenches [n, (p - c) x n / r] span the convex cone of all wrenches; c is the mean position, r
/// the largest distance from it. every dropped wrench is a non-negative combination of the kept ones to within
/// `tolerance` (distance over length of the wrench).
std::vector<Contact> reduceToCone(std::span<const Contact> contacts, double tolerance = 1e-3);

/// Distance of the wrench of `contact` from the cone spanned by `kept`, over its length; same scaling as reduceToCone
/// with centre and scale taken from `all`.
double distanceToCone(const Contact& contact, std::span<const Contact> kept, std::span<const Contact> all);

/// At most `count`: the deepest of every region first, deepest regions first when there are more regions than places.
/// Then farthest-point in position and normal over the rest, up to 1,024 places, beyond which spreading costs more than
/// it gives. Then the deepest of what is left. Deepest first in the result, ties by ids.
std::vector<Contact> limitContacts(std::span<const Contact> contacts, int count);
/// The same into `out`, which is none of the contacts' own vector.
void limitContacts(std::span<const Contact> contacts, int count, std::vector<Contact>& out);

}  // namespace otg
