// SPDX-License-Identifier: BSD-3-Clause
// Searches of one eight-way tree: which triangles may meet a ball, a half space, a turned box or a ray. Boxes are
// tested eight at once in single precision, each query made larger by more than the rounding: nothing is missed, and
// what is found still has to be tested itself.
#pragma once

#include <cstdint>
#include <type_traits>

#include "bvh/collision_mesh.h"

namespace otg {

/// All points within a distance. The centre is in the mesh's frame.
class BallQuery {
 public:
  BallQuery(const CollisionMesh& tree, const Vec3d& center, double radius);
  /// Bit k is set if the box of child k may have a point in the ball.
  unsigned operator()(const WideNode& node) const;

 private:
  template <bool kScaled>
  unsigned test(const WideNode& node) const;

  const BoxScale<float>* scale_;  ///< CollisionMesh::boxScale()
  float x_, y_, z_, reach2_;
};

/// All points with normal . x <= offset, in the mesh's frame; the normal has length 1.
class BelowQuery {
 public:
  BelowQuery(const CollisionMesh& tree, const Vec3d& normal, double offset);
  unsigned operator()(const WideNode& node) const;

 private:
  template <bool kScaled>
  unsigned test(const WideNode& node) const;

  const BoxScale<float>* scale_;
  float n_[3], size_[3], offset_;
};

/// All points of a box that is turned. `toMesh` takes its frame, in which it is centred, to the mesh's.
class BoxQuery {
 public:
  BoxQuery(const CollisionMesh& tree, const Transformd& toMesh, const Vec3d& half);
  unsigned operator()(const WideNode& node) const;

 private:
  template <bool kScaled>
  unsigned test(const WideNode& node) const;

  const BoxScale<float>* scale_;
  float r_[9], size_[9];  ///< the box's axes as columns, and their components' sizes
  float center_[3], half_[3], inMesh_[3];
};

/// Points origin + t direction, t >= 0, in the mesh's frame.
class RayQuery {
 public:
  RayQuery(const CollisionMesh& tree, const Vec3d& origin, const Vec3d& direction);
  /// False if the ray misses the mesh as a whole.
  bool meets() const { return meets_; }
  /// Bit k is set if the ray may meet the box of child k at a t up to `limit`; near[k] is where it enters, at the
  /// latest.
  unsigned children(const WideNode& node, double limit, float near[kWideArity]) const;
  /// Whether what begins at `near` may hold a point up to `limit`.
  bool isBefore(float near, double limit) const { return double{near} <= (limit - start_) + slack_; }

 private:
  template <bool kScaled>
  unsigned test(const WideNode& node, double limit, float near[kWideArity]) const;

  const BoxScale<float>* scale_;
  float o_[3], inverse_[3], sign_[3], wider_;
  double start_ = 0;  ///< t where single precision takes over: where the ray enters the mesh's bounds
  double slack_ = 0;
  bool meets_ = false;
};

/// Calls visit(triangle) for every triangle that the query's boxes lead to, in the order of the tree; if it returns
/// bool, until that is false. Returns whether it came to the end.
template <class QueryOfBoxes, class Visit>
bool searchWide(const WideTree& tree, const QueryOfBoxes& query, const Visit& visit) {
  if (tree.nodes.empty()) return true;
  std::int32_t stack[kWideArity * (kMaxTreeDepth + 1)];
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const WideNode& node = tree.nodes[static_cast<std::size_t>(stack[--top])];
    for (unsigned bits = query(node); bits != 0; bits &= bits - 1) {
      const std::int32_t child = node.child[__builtin_ctz(bits)];
      if (child < 0) {
        const auto triangle = static_cast<std::uint32_t>(~child);
        if constexpr (std::is_same_v<std::invoke_result_t<Visit, std::uint32_t>, bool>) {
          if (!visit(triangle)) return false;
        } else {
          visit(triangle);
        }
      } else {
        stack[top++] = child;
      }
    }
  }
  return true;
}

}  // namespace otg
