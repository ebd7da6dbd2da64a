// SPDX-License-Identifier: BSD-3-Clause
// Families of random pairs in overlap, many of them in inner corners: certificates are made for these.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "truth/contact_families.h"
#include "truth/nests.h"
#include "truth/pair_oracle.h"

namespace otg::truth {

/// Two bodies in the host's frame before they are subdivided, scaled, turned and moved together.
struct PairDraft {
  PairBody host, mover;
  OverlapRange overlaps = kShallowOverlaps;
  double depth = 0;      ///< how far the mover was pushed in, about
  bool aligned = false;  ///< faces are parallel exactly: the pair is not turned in the world
  std::string what;
};

struct CertificateFamily {
  std::string name, what;
  /// Into a draft whose overlaps are set. False where the draw did not come out as a pair of the family.
  std::function<bool(Random&, PairDraft&)> draw;
};

std::vector<CertificateFamily> certificateFamilies();

/// One of some closed meshes, with any of them on it. They come in any size, and are brought to like ones.
CertificateFamily bodyFamily(const std::string& name, const std::vector<std::shared_ptr<const TriMesh>>& bodies,
                             std::size_t host);

/// A pair that is known to overlap.
struct CertificateMember {
  PairBody a, b;            ///< in the world
  PairBody plainA, plainB;  ///< the same bodies with as few triangles as the family has them
  double size = 0;          ///< least side of the smaller body's box
  Vec3d shortest;           ///< the shortest translation of A that separates the plain bodies, by search
  std::string what;

  double grain() const;  ///< what counts as touching
};

/// The same member for the same seed, family and number on every machine; none where fifty draws gave no pair in
/// such an overlap.
std::optional<CertificateMember> certificateMember(const CertificateFamily& family, std::uint32_t seed, int number,
                                                   const OverlapRange& overlaps = kShallowOverlaps);

}  // namespace otg::truth
