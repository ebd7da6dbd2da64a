// SPDX-License-Identifier: BSD-3-Clause
// Two convex polyhedra, one placed in the other's frame, and the body of their differences.
#pragma once

#include "base/vectors.h"
#include "mesh/convex_polyhedron.h"

namespace otg {

/// Everything is in A's frame. With m, a unit direction out of A towards B: the *overlap along m* is how far A reaches
/// along m, less where B begins there. A moved by so much against m is clear of B. The bodies are apart exactly if the
/// overlap along some direction is negative; their depth is the least overlap of all directions.
class ConvexPair {
 public:
  ConvexPair(const ConvexPolyhedron& a, const ConvexPolyhedron& b, const Transformd& bInA)
      : a_(a), b_(b), pose_(bInA) {}

  const ConvexPolyhedron& a() const { return a_; }
  const ConvexPolyhedron& b() const { return b_; }
  const Transformd& pose() const { return pose_; }
  const ConvexPolyhedron& body(int m) const { return m == 0 ? a_ : b_; }
  Vec3d place(int m, std::uint32_t vertex) const {
    return m == 0 ? a_.vertices()[vertex] : otgTransform(pose_, b_.vertices()[vertex]);
  }
  /// Outward, of a face; of unit length as far as the pose is a rotation.
  Vec3d normal(int m, std::uint32_t face) const {
    return m == 0 ? a_.face(face).normal : otgRotate(pose_, b_.face(face).normal);
  }
  Vec3d rotated(const Vec3d& ofB) const { return otgRotate(pose_, ofB); }
  /// The vertex of a body that is farthest along a direction.
  std::uint32_t farthest(int m, const Vec3d& direction) const {
    return m == 0 ? a_.support(direction) : b_.support(otgRotateBack(pose_, direction));
  }

  /// How far a body reaches both ways along a direction.
  ConvexPolyhedron::Reach reach(int m, const Vec3d& direction) const {
    if (m == 0) return a_.reach(direction);
    const ConvexPolyhedron::Reach own = b_.reach(otgRotateBack(pose_, direction));
    const double moved = otgDot(direction, pose_.t);
    return {own.least + moved, own.most + moved};
  }

  /// Where the body of differences, a - b for all a and b, is farthest along m.
  struct Difference {
    Vec3d at;
    std::uint32_t a, b;  ///< the two vertices
  };
  Difference difference(const Vec3d& m) const {
    const std::uint32_t a = a_.support(m), b = b_.support(otgRotateBack(pose_, otgScale(m, -1.0)));
    return {place(0, a) - place(1, b), a, b};
  }
  double overlapAlong(const Vec3d& m) const { return otgDot(m, difference(m).at); }

 private:
  const ConvexPolyhedron &a_, &b_;
  const Transformd& pose_;
};

/// The direction of the least overlap.
struct ConvexAxis {
  enum class Of : std::uint8_t { kNone, kFaceA, kFaceB, kEdges };
  Of of = Of::kNone;   ///< kNone: the bodies are apart
  Vec3d m{0, 0, 0};    ///< unit
  double overlap = 0;  ///< along it; not negative but for kNone
  /// Of kFaceA and kFaceB: which face's normal m is.
  std::uint32_t face = kNone;
};

/// A face's normal is taken in place of a direction between edges if it costs at most so much more: as a share of the
/// overlap, and of the bodies' size.
inline constexpr double kFaceShare = 1e-3, kFaceSlack = 1e-9;

}  // namespace otg
