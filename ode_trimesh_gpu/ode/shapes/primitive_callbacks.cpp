// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/primitive_callbacks.h"

#include <algorithm>
#include <map>

#include "collide/pairwise/reduction.h"
#include "dispatch/threads/workspace_lease.h"
#include "ode/pairs/pair_callbacks.h"
#include "ode/shapes/convex_collider.h"
#include "ode/shapes/heightfield_collider.h"
#include "ode/shapes/primitive_contacts.h"
#include "primitives/touched_triangles.h"

namespace otg {
namespace {

/// In the mesh's own numbers.
std::vector<std::uint32_t> touchedTriangles(const PrimitiveTask& task, int& failure) {
  const CollisionMesh& mesh = *task.side.mesh;
  switch (dGeomGetClass(task.o2)) {
    case dPlaneClass:
      return trianglesTouching(mesh, planeInMesh(task));
    case dSphereClass:
      return trianglesTouching(mesh, task.other.t, static_cast<double>(dGeomSphereGetRadius(task.o2)));
    case dHeightfieldClass: {
      const WorkspaceLease lease;
      return trianglesOnHeightfield(task, *lease, failure);
    }
    default: {
      const std::shared_ptr<const ConvexShape> shape = shapeOfGeom(task.o2);
      if (shape == nullptr) return {};
      const WorkspaceLease lease;
      return trianglesTouching(mesh, *shape, task.other, *lease);
    }
  }
}

class TriangleAnswers {
 public:
  explicit TriangleAnswers(const PrimitiveTask& task) : task_(task) {}

  void tell(const std::vector<std::uint32_t>& own) {
    dTriArrayCallback* const callback = task_.side.callbacks.triangles;
    if (callback == nullptr || own.empty()) return;
    std::vector<int> numbers;
    numbers.reserve(own.size());
    for (const std::uint32_t t : own) numbers.push_back(static_cast<int>(task_.side.mesh->mesh().callerTriangle(t)));
    std::sort(numbers.begin(), numbers.end());
    callback(task_.o1, task_.o2, numbers.data(), static_cast<int>(numbers.size()));
  }
  /// A caller's number.
  bool mayCollide(std::uint32_t triangle) {
    dTriCallback* const callback = task_.side.callbacks.triangle;
    if (callback == nullptr) return true;
    const auto [it, isNew] = answers_.try_emplace(triangle, true);
    if (isNew) it->second = callback(task_.o1, task_.o2, static_cast<int>(triangle)) != 0;
    return it->second;
  }

 private:
  const PrimitiveTask& task_;
  std::map<std::uint32_t, bool> answers_;
};

}  // namespace

void askedContacts(PrimitiveTask& task, int most, std::vector<Contact>& out, int& failure) {
  const TriMesh& whole = task.side.mesh->mesh();
  std::vector<std::uint32_t> touched = touchedTriangles(task, failure);
  if (failure != 0) return;
  TriangleAnswers answers(task);
  answers.tell(touched);
  // Called in the order of the caller's numbers, whatever ours are.
  std::sort(touched.begin(), touched.end(),
            [&](std::uint32_t x, std::uint32_t y) { return whole.callerTriangle(x) < whole.callerTriangle(y); });
  std::vector<std::uint32_t> allowed;
  for (const std::uint32_t t : touched) {
    if (answers.mayCollide(whole.callerTriangle(t))) allowed.push_back(t);
  }
  std::vector<Contact> all;
  constexpr int kAll = 65535;
  if (allowed.size() == touched.size()) {
    primitiveContacts(task, kAll, all, failure);
  } else {
    std::sort(allowed.begin(), allowed.end());
    const std::shared_ptr<const CollisionMesh> rest = meshOfTriangles(whole, allowed);
    const CollisionMesh* const mesh = std::exchange(task.side.mesh, rest.get());
    if (!allowed.empty()) primitiveContacts(task, kAll, all, failure);
    task.side.mesh = mesh;
    for (Contact& c : all) c.triangleA = allowed[c.triangleA];
  }
  // A shape inside a solid may touch no triangle; its contacts name the nearest ones all the same.
  std::erase_if(all, [&](const Contact& c) { return !answers.mayCollide(whole.callerTriangle(c.triangleA)); });
  out = all.size() > static_cast<std::size_t>(most) ? limitContacts(all, most) : all;
  for (std::vector<Contact>* contacts : {&all, &out}) {
    for (Contact& c : *contacts) c.triangleA = whole.callerTriangle(c.triangleA);
  }
  if (task.side.callbacks.merge != nullptr && !out.empty())
    mergeNumbers(task.side.callbacks.merge, task.side.geom, true, all, out);
}

}  // namespace otg
