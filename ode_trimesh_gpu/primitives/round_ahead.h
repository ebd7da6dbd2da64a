// SPDX-License-Identifier: BSD-3-Clause
// Walls that a round shape meets on the way which its contacts request, as lookAhead() for two meshes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory_resource>
#include <vector>

#include "base/insertion_sort.h"
#include "base/vectors.h"
#include "collide/shortest_translation.h"
#include "collide/solid/look_ahead.h"
#include "queries/surface_side.h"

namespace otg {

/// Completes the contacts from `first` on, which are those of a round shape with a solid; deepest first again.
/// `addTouched(way)` appends the contacts of the shape as they are after the mesh has moved by `way`. `share`: where a
/// contact's position is between the mesh's surface (0) and the shape's (1).
template <class AddTouched>
void addWallsAhead(const CollisionMesh& mesh, double share, std::vector<Contact>& contacts, std::size_t first,
                   const AddTouched& addTouched) {
  if (contacts.size() == first || surfaceKind(mesh.mesh()) != SurfaceKind::kSolid || !isCornered(&mesh)) return;
  double longest = 0;
  for (std::size_t i = first; i < contacts.size(); ++i) longest = std::max(longest, kLongestAhead * contacts[i].depth);
  constexpr std::size_t kContactsAtHand = 32;  // on the stack; more are rare
  std::byte buffer[kContactsAtHand * sizeof(Contact)];
  std::pmr::monotonic_buffer_resource memory(buffer, sizeof buffer);
  ShortestTranslation t(&memory);
  for (std::size_t i = first; i < contacts.size(); ++i) {
    if (!t.add(contacts[i].normal, contacts[i].depth, longest)) return;
  }
  bool isNew = true;
  for (int look = 0; look < kLooksAhead && isNew; ++look) {
    const Vec3d way = t.value() * kFartherAhead;
    const std::size_t before = contacts.size();
    addTouched(way);
    std::size_t end = before;
    for (std::size_t i = before; i < contacts.size(); ++i) {
      Contact c = contacts[i];
      const double depth = c.depth + otgDot(c.normal, way);
      if (t.satisfies(c.normal, depth) || !t.add(c.normal, depth, longest)) continue;
      c.position = c.position + c.normal * (share * (depth - c.depth));
      c.depth = std::max(depth, 0.0);
      c.region = static_cast<std::uint32_t>(end - first);
      contacts[end++] = c;
    }
    isNew = end > before;
    contacts.resize(end);
  }
  insertionSort(contacts.begin() + static_cast<std::ptrdiff_t>(first), contacts.end(),
                [](const Contact& x, const Contact& y) { return x.depth > y.depth; });
}

}  // namespace otg
