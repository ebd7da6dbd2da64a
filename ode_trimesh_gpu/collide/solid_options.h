// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the object-level contact model, and what it may remember of a pair.
#pragma once

#include <cstdint>

#include "shared/math/vec3.h"

namespace otg {

struct SolidOptions {
  int contactsPerRegion =
      16;                  ///< at most this many contacts from one connected overlap region; the C API takes 1 to 64
  double regionMerge = 0;  ///< regions with contacts at most this far apart and normals alike are one (merge_regions.h)
  /// Two convex meshes take the way of convex/convex_pair_contacts.h, which looks at no triangles. Geoms and `otg` have
  /// it on. It is off by default, for those who request the stages that any solids have.
  bool convexPath = false;
  friend bool operator==(const SolidOptions&, const SolidOptions&) = default;
};

/// What one query of a pair leaves for the next. Optional: a query without it uses the geometry alone.
///
/// A query at the very pose of the last one starts from the same state as that did. So querying twice, or from two
/// threads, changes nothing.
struct SolidHistory {
  struct State {
    Vec3d escape{0, 0, 0};  ///< unit, in B's frame: the direction in which an entangled or contained body is leaving
    int escapeLeft = 0;     ///< queries for which it still holds
    int clampLeft = 0;      ///< queries for which the depths of the pair stay clamped
    Vec3d deepNormal{0, 0, 0};  ///< unit, in B's frame: the direction of the last deep region; zero when out of contact
    Transformd pose{};          ///< of B in A at the last query
    bool hasPose = false;
    bool isJammed = false;  ///< all of the pair leaves along `escape`
    /// Of a pair with a shell, 0 if nothing is known (shell/shell_approach.h): on which side of a sheet the visitor is,
    /// +1 where its normals lead, or -1; of another ground +1, and `front` is a point in front of it, in its own frame.
    /// Of a solid on a sheet: -1 behind it, +1 if it has come there through the front.
    int side = 0;
    Vec3d front{0, 0, 0};
    double deepest = -1;        ///< contact of the last query, 0 without any; less if that bounds nothing
    std::uint64_t content = 0;  ///< of both meshes then: once their triangles have moved, `deepest` bounds nothing

    /// Whether it is of use after a query without contacts: the pair has a sheet or a shell.
    bool outlastsContacts() const { return side != 0 || deepest >= 0; }
  };
  /// The direction that a convex pair had last: where to look first. No result depends on it, so it is not part of
  /// what is saved.
  struct KeptAxis {
    std::uint64_t a = 0, b = 0;  ///< ConvexPolyhedron::stamp() of the two bodies; 0 for none
    Transformd pose{};
    Vec3d m{0, 0, 0};  ///< as in ConvexAxis, as are the others
    double overlap = 0;
    std::uint32_t face = 0;
    std::uint8_t of = 0;
  };
  State before;   ///< what the last query started from
  State current;  ///< what it left
  bool used = false;
  KeptAxis kept;

  static constexpr int kEscapeQueries = 50;
  static constexpr int kClampQueries = 20;
  static constexpr double kClampedDepth = 0.02;  ///< of the smaller mesh's size
};

}  // namespace otg
