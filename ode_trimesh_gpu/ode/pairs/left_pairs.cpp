// SPDX-License-Identifier: BSD-3-Clause
#include "ode/pairs/left_pairs.h"

#include <ode/ode.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <utility>

#include "base/vectors.h"
#include "collide/pair_history.h"
#include "collide/shell/shell_roles.h"

struct dxGeom;
/// ODE's collider of two dTriMesh geoms. Not of its public interface: there where libode shows it, or is linked
/// statically.
int dCollideTTL(dxGeom*, dxGeom*, int, dContactGeom*, int) __attribute__((weak));

namespace otg {
namespace {

std::atomic<bool> hasMargin{false};

constexpr double kThin = 0.05;  // of the radius

/// Whether the geom's box has next to no height along an axis of the world, for a visitor of that radius.
bool liesAlongAxes(dGeomID geom, double radius) {
  dReal box[6];
  dGeomGetAABB(geom, box);
  const dReal least = std::min({box[1] - box[0], box[3] - box[2], box[5] - box[4]});
  return static_cast<double>(least) < kThin * radius;
}

/// Loose triangles, most of them long and thin. By some of them, because each pair needs it.
bool isOfSlivers(const CollisionMesh& mesh) {
  constexpr double kSliver = 0.1;  // of the area of a square over the longest edge
  const TriMesh& triangles = mesh.mesh();
  if (!isSheet(triangles) || triangles.report().boundaryEdges == 0) return false;
  if (triangles.topology().componentCount() < 2 || !mesh.outwardSides().empty()) return false;
  double area = 0, squares = 0;
  const auto count = static_cast<std::uint32_t>(triangles.triangleCount());
  for (std::uint32_t t = 0; t < count; t += std::max(1u, count / 64)) {
    double longest2 = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3f& p = triangles.vertices()[triangles.triangles()[t].v[k]];
      const Vec3f& q = triangles.vertices()[triangles.triangles()[t].v[(k + 1) % 3]];
      const Vec3d d{double{q.x} - p.x, double{q.y} - p.y, double{q.z} - p.z};
      longest2 = std::max(longest2, otgDot(d, d));
    }
    area += mesh.adjacency().area[t];
    squares += longest2;
  }
  return area < kSliver * squares;
}

void say(std::atomic<bool>& said, const char* what) {
  if (!said.exchange(true)) {
    std::fprintf(stderr, "ode_trimesh_gpu: pairs of %s are left to ODE (docs/drop_in.md)\n", what);
  }
}

}  // namespace

bool isFlat(const CollisionMesh& mesh) {
  const TriMesh& triangles = mesh.mesh();
  const std::vector<Vec3d>& normals = mesh.adjacency().normal;
  const std::vector<double>& areas = mesh.adjacency().area;
  const auto largest = std::max_element(areas.begin(), areas.end());
  if (largest == areas.end() || *largest == 0) return false;
  const auto widest = static_cast<std::uint32_t>(largest - areas.begin());
  const auto at = [&](std::uint32_t v) {
    const Vec3f& p = triangles.vertices()[v];
    return Vec3d{p.x, p.y, p.z};
  };
  const Vec3d on = at(triangles.triangles()[widest].v[0]), normal = normals[widest];
  const double most = kThin * static_cast<double>(triangles.radius());
  return std::all_of(triangles.triangles().begin(), triangles.triangles().end(), [&](const Triangle& t) {
    return std::all_of(t.v, t.v + 3, [&](std::uint32_t v) { return std::fabs(otgDot(normal, at(v) - on)) <= most; });
  });
}

void noteMargin() noexcept {
  hasMargin = true;
}

bool isLeftToOde(const MeshGeom& side1, const MeshGeom& side2) {
  if (&dCollideTTL == nullptr || side1.ownObject == nullptr || side2.ownObject == nullptr) return false;
  if (side1.mesh == nullptr || side2.mesh == nullptr) return false;
  const TriMesh &mesh1 = side1.mesh->mesh(), &mesh2 = side2.mesh->mesh();
  if (mesh1.meshClass() == MeshClass::kSolid && mesh2.meshClass() == MeshClass::kSolid) return false;
  const auto model = pairOptions(side1.object->params, side2.object->params).contacts;
  if (model != ContactModel::kSolid) return false;
  const bool isFirst = isGround(mesh1, mesh2);
  const MeshGeom &ground = isFirst ? side1 : side2, &visitor = isFirst ? side2 : side1;
  static std::atomic<bool> saidFlat{false}, saidSlivers{false};
  const double radius = static_cast<double>(visitor.mesh->mesh().radius());
  if (!hasMargin && liesAlongAxes(ground.geom, radius) && isFlat(*visitor.mesh)) {
    say(saidFlat, "flat dTriMesh geoms");
    return true;
  }
  if (isOfSlivers(*ground.mesh)) {
    say(saidSlivers, "a dTriMesh and a dTriMesh of loose slivers");
    return true;
  }
  return false;
}

int collideByOde(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip) {
  // ODE hands a pair of one class to a collider that was set with its geoms exchanged, and to its own as they are.
  const int count = dCollideTTL(o2, o1, flags, contact, skip);
  for (int i = 0; i < count; ++i) {
    auto* const c = reinterpret_cast<dContactGeom*>(reinterpret_cast<char*>(contact) + std::ptrdiff_t{i} * skip);
    for (dReal* n = c->normal; n < c->normal + 3; ++n) *n = -*n;
    std::swap(c->g1, c->g2);
    std::swap(c->side1, c->side2);
  }
  return count;
}

std::vector<Contact> contactsByOde(const PairTask& task, int most) {
  std::vector<dContactGeom> found(static_cast<std::size_t>(most));
  // No one has exchanged the geoms of an array.
  const int count = dCollideTTL(task.side1.geom, task.side2.geom, most, found.data(), sizeof(dContactGeom));
  std::vector<Contact> contacts;
  for (int i = 0; i < count; ++i) {
    const dContactGeom& from = found[static_cast<std::size_t>(i)];
    Contact c{};
    const Vec3d at{from.pos[0], from.pos[1], from.pos[2]}, normal{from.normal[0], from.normal[1], from.normal[2]};
    c.position = otgRotateBack(task.poseOfA, otgSub(at, task.poseOfA.t));
    c.normal = otgScale(otgRotateBack(task.poseOfA, normal), task.first ? 1.0 : -1.0);
    c.depth = from.depth;
    c.triangleA = static_cast<std::uint32_t>(task.first ? from.side1 : from.side2);
    c.triangleB = static_cast<std::uint32_t>(task.first ? from.side2 : from.side1);
    contacts.push_back(c);
  }
  return contacts;
}

}  // namespace otg
