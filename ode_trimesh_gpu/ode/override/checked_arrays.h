// SPDX-License-Identifier: BSD-3-Clause
// Arrays that a program gives ODE for a dTriMesh, as ODE can take them. Part of the preload library.
#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <vector>

namespace otg {

/// Indices in place of those that a program gave.
struct CheckedIndices {
  const void* indices = nullptr;
  int count = 0, stride = 0;
  bool isEmpty = false;  ///< no triangles: nothing for ODE, which would abort
};

/// Looks through the indices of a dGeomTriMeshDataBuild...(), whose arguments these are. A triangle with an index that
/// no vertex has becomes one without area, at the first vertex: ODE would read far away for it. Then there is one line
/// on stderr, and indices of our own stay with the data until they are built again or forgotten. `function` is named in
/// that line. Throws std::bad_alloc.
CheckedIndices checkIndices(dTriMeshDataID data, const char* function, const void* vertices, int vertexCount,
                            const void* indices, int indexCount, int stride);

/// Says whether a build of data without triangles can be left out, because they have not been built before. Where that
/// is not so, they have to be built from something that touches nothing: noTriangles().
bool staysUnbuilt(dTriMeshDataID data);
/// ODE's own colliders crash with a single triangle of that kind.
struct NoTriangles {
  float vertices[3] = {0, 0, 0};
  std::uint32_t indices[6] = {0, 0, 0, 0, 0, 0};
};
const NoTriangles& noTriangles();

/// Whether the last build of the data had no triangles, or there are no data.
bool hasNoTriangles(dTriMeshDataID data) noexcept;
/// Whether it is a dTriMesh with such data, which nothing may collide with: ODE's colliders would abort.
bool isEmptyTrimesh(dGeomID geom) noexcept;
/// Data that are destroyed.
void forgetIndices(dTriMeshDataID data) noexcept;

/// As dCollide() understands them, of flags that it would abort with: of a number of contacts that its 16 bits do not
/// hold the largest that they do. 0 where none are wanted.
int allowedFlags(int flags) noexcept;

}  // namespace otg
