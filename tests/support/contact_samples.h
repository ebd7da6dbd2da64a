// SPDX-License-Identifier: BSD-3-Clause
// Contacts made by formula, and what tests ask about sets of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "base/vectors.h"
#include "collide/query.h"
#include "support/draw.h"

namespace otg::test {

inline Contact makeContact(Vec3d position, Vec3d normal, double depth, std::uint32_t a = 0, std::uint32_t b = 0,
                           std::uint32_t region = 0, ContactFeature feature = ContactFeature::kFaceA) {
  const double length = norm(normal);
  return {position, otgScale(normal, 1 / length), depth, a, b, region, feature};
}

/// Normals within about `spread` of +z (2 and more: all directions), positions in a flattish box, ids unique.
inline std::vector<Contact> randomContacts(std::uint32_t seed, std::size_t count, double spread,
                                           std::uint32_t regions = 1) {
  Draw draw(seed);
  std::vector<Contact> contacts;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d d = draw.direction();
    const Vec3d normal = otgAdd(otgScale(d, spread), otgVec(0.0, 0.0, spread >= 2 ? 0.0 : 1.0));
    const Vec3d p = draw.inBox(1);
    const auto id = static_cast<std::uint32_t>(i);
    contacts.push_back(makeContact(otgVec(p.x, 0.7 * p.y, 0.2 * p.z), normal, draw.uniform(0, 0.01), id / 3,
                                   id % 7 + id, draw.below(regions)));
  }
  return contacts;
}

/// A contour as two smooth bodies make it: positions on a wavy ring, normals leaning inward with the place.
inline std::vector<Contact> ringContacts(std::size_t count) {
  std::vector<Contact> contacts;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(count);
    const Vec3d p{std::cos(t), 0.8 * std::sin(t), 0.05 * std::sin(5 * t)};
    const Vec3d n{-0.3 * p.x + 0.05 * std::sin(11 * t), -0.3 * p.y, 1.0};
    const auto id = static_cast<std::uint32_t>(i);
    contacts.push_back(makeContact(p, n, 0.001 * (1 + std::sin(3 * t)), id, id / 2));
  }
  return contacts;
}

inline std::vector<Contact> shuffled(std::vector<Contact> contacts, std::uint32_t seed) {
  Draw draw(seed);
  for (std::size_t i = contacts.size(); i > 1; --i) {
    std::swap(contacts[i - 1], contacts[draw.below(static_cast<std::uint32_t>(i))]);
  }
  return contacts;
}

inline bool same(const Contact& x, const Contact& y) {
  return x.position == y.position && x.normal == y.normal && x.depth == y.depth && x.triangleA == y.triangleA &&
         x.triangleB == y.triangleB && x.region == y.region && x.feature == y.feature;
}

inline bool same(std::span<const Contact> x, std::span<const Contact> y) {
  return std::equal(x.begin(), x.end(), y.begin(), y.end(),
                    [](const Contact& a, const Contact& b) { return same(a, b); });
}

inline bool contains(std::span<const Contact> contacts, const Contact& c) {
  return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& other) { return same(other, c); });
}

}  // namespace otg::test
