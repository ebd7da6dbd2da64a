// SPDX-License-Identifier: BSD-3-Clause
// What the contacts of a mesh with a geom of ODE's own are a function of.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "collide/query.h"
#include "ode/shapes/primitive_task.h"
#include "primitives/convex_shape.h"

namespace otg {

/// What the contacts of a pair depend on.
struct ShapeQuery {
  static constexpr bool kIsWhole = false;  ///< see KeptContacts
  int geomClass = -1;
  std::array<double, 4> size{};              ///< a plane's numbers, in the mesh's frame
  std::shared_ptr<const ConvexShape> shape;  ///< of a convex: found again by its corners
  Transformd pose{};                         ///< of the geom in the mesh's frame
  Vec3d velocity{0, 0, 0};                   ///< relative, where contacts depend on it
  CollideOptions options;                    ///< with as many contacts as the mesh's geom allows
  std::weak_ptr<const void> mesh;            ///< CollisionMesh::lifetime(): a mesh that has moved is another
  std::uint64_t stamp = 0;                   ///< of what is remembered of the pair
  bool remembers = false;
};

/// The query of a prepared task. Reads what is remembered. May throw std::bad_alloc.
ShapeQuery shapeQuery(const PrimitiveTask& task);
/// Whether two queries have the same result, to the last bit.
bool sameQuery(const ShapeQuery& x, const ShapeQuery& y);

}  // namespace otg
