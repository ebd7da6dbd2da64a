// SPDX-License-Identifier: BSD-3-Clause
// Bodies and grounds that are no solids, and a world in which they are let go.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "support/draw.h"
#include "support/ode_trimesh.h"
#include "support/ode_world.h"
#include "support/sheet_scenes.h"
#include "support/step_world.h"

namespace otg::test {

/// A flat square in the plane z = 0 with its middle at the origin, of 2 cells^2 triangles that face up.
inline scenes::MeshArrays flatSheet(double sizeX, double sizeY, int cells) {
  return scaled(terrain(1, cells, 0), {sizeX, sizeY, 1});
}

inline Triangle turned(const Triangle& t) {
  return {{t.v[0], t.v[2], t.v[1]}};
}
/// Every triangle and, at the same places, one that faces the other way.
inline scenes::MeshArrays twoSided(scenes::MeshArrays mesh) {
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; ++i) mesh.triangles.push_back(turned(mesh.triangles[i]));
  return mesh;
}
/// Every triangle twice.
inline scenes::MeshArrays doubled(scenes::MeshArrays mesh) {
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; ++i) mesh.triangles.push_back(mesh.triangles[i]);
  return mesh;
}
/// All triangles facing the other way.
inline scenes::MeshArrays turned(scenes::MeshArrays mesh) {
  for (Triangle& t : mesh.triangles) t = turned(t);
  return mesh;
}
/// Without the triangles that lie wholly in the plane z = `height`.
inline scenes::MeshArrays withoutLid(scenes::MeshArrays mesh, float height) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return mesh.vertices[t.v[0]].z == height && mesh.vertices[t.v[1]].z == height && mesh.vertices[t.v[2]].z == height;
  });
  return mesh;
}

/// What is dropped.
enum class ShellBody { kQuad, kFineSheet, kTwoSidedQuad, kOpenBox, kMisoriented, kDoubled, kClosedBox };
inline constexpr std::array kShellBodies = {ShellBody::kQuad,     ShellBody::kFineSheet,   ShellBody::kTwoSidedQuad,
                                            ShellBody::kOpenBox,  ShellBody::kMisoriented, ShellBody::kDoubled,
                                            ShellBody::kClosedBox};
inline const char* nameOf(ShellBody body) {
  constexpr const char* kNames[] = {"quad",        "fine sheet", "two-sided quad", "box without lid",
                                    "misoriented", "doubled",    "closed box"};
  return kNames[static_cast<int>(body)];
}
/// Of sides `size`; sheets have two of them.
inline scenes::MeshArrays makeBody(ShellBody body, const Vec3d& size) {
  scenes::MeshArrays box = scenes::makeBox(size);
  switch (body) {
    case ShellBody::kQuad:
      return flatSheet(size.x, size.y, 1);
    case ShellBody::kFineSheet:
      return flatSheet(size.x, size.y, 20);
    case ShellBody::kTwoSidedQuad:
      return twoSided(flatSheet(size.x, size.y, 1));
    case ShellBody::kOpenBox:
      return withoutLid(box, static_cast<float>(size.z / 2));
    case ShellBody::kMisoriented:
      box.triangles[5] = turned(box.triangles[5]);
      return box;
    case ShellBody::kDoubled:
      return doubled(box);
    default:
      return box;
  }
}

/// Whether geoms are of our class, or ODE's own dTriMesh geoms.
enum class GeomForm { kOurs, kOde };

/// A mesh as data of either form, for as long as its geoms live.
class ShellData {
 public:
  ShellData(const scenes::MeshArrays& mesh, GeomForm form) {
    if (form == GeomForm::kOurs) ours_ = std::make_unique<Data>(mesh);
    if (form == GeomForm::kOde) ode_ = std::make_unique<OdeMesh>(mesh);
  }
  dGeomID geom(dSpaceID space) const {
    if (ours_ != nullptr) return dCreateGpuTriMesh(space, ours_->id);
    const dGeomID geom = dCreateTriMesh(space, ode_->id, nullptr, nullptr, nullptr);
    dGpuTriMeshOverrideForgetGeom(geom);  // the one that was at this address
    return geom;
  }

 private:
  std::unique_ptr<Data> ours_;
  std::unique_ptr<OdeMesh> ode_;
};

/// A body above a ground, let go.
struct ShellDrop {
  scenes::MeshArrays body;
  Vec3d size{};  ///< sides of the body, whose mass is that of a box
  Transformd pose{};
  Vec3d velocity{0, 0, 0}, spin{0, 0, 0};
};

struct ShellEnd {
  Vec3d position{}, velocity{}, spin{};
  double fastest = 0;  ///< of all steps
  double moved = 0;    ///< in the last half second
};

inline ShellEnd letGo(const ShellData& ground, const ShellDrop& drop, GeomForm form, int steps, double mu = 1) {
  const ShellData data(drop.body, form);
  StepWorld world(mu);
  ground.geom(world.space());
  const dGeomID geom = data.geom(world.space());
  dMass mass;
  dMassSetBoxTotal(&mass, 1, drop.size.x, drop.size.y, drop.size.z);
  const dBodyID body = world.addBody(geom, mass);
  dMatrix3 r;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r[4 * i + j] = drop.pose.r[3 * i + j];
  }
  dBodySetRotation(body, r);
  dBodySetPosition(body, drop.pose.t.x, drop.pose.t.y, drop.pose.t.z);
  dBodySetLinearVel(body, drop.velocity.x, drop.velocity.y, drop.velocity.z);
  dBodySetAngularVel(body, drop.spin.x, drop.spin.y, drop.spin.z);
  ShellEnd end;
  const auto toVec = [](const dReal* p) { return Vec3d{p[0], p[1], p[2]}; };
  for (int i = 0; i < steps; ++i) {
    world.step(1);
    end.velocity = toVec(dBodyGetLinearVel(body));
    end.fastest = std::max(end.fastest, std::sqrt(otgDot(end.velocity, end.velocity)));
    if (i == steps - 100) end.position = toVec(dBodyGetPosition(body));
  }
  const Vec3d moved = otgSub(toVec(dBodyGetPosition(body)), end.position);
  end.moved = std::sqrt(otgDot(moved, moved));
  end.position = toVec(dBodyGetPosition(body));
  end.spin = toVec(dBodyGetAngularVel(body));
  return end;
}

/// A body with random sides, turned at random, whose lowest vertex is `clearance` over the highest vertex of the ground
/// that lies below it.
inline ShellDrop randomDrop(ShellBody kind, const scenes::MeshArrays& ground, double reach, double clearance,
                            Draw& draw) {
  ShellDrop drop;
  drop.size = {draw.uniform(0.4, 1.2), draw.uniform(0.4, 1.2), draw.uniform(0.3, 0.8)};
  drop.body = makeBody(kind, drop.size);
  drop.pose = makePose(draw.direction(), draw.uniform(0, 6.28), {0, 0, 0});
  drop.pose.t = {draw.uniform(-reach, reach), draw.uniform(-reach, reach), 0};
  double lowest = 0, highest = -10;
  for (const Vec3f& v : drop.body.vertices) lowest = std::min(lowest, otgTransform(drop.pose, Vec3d{v.x, v.y, v.z}).z);
  for (const Vec3f& v : ground.vertices) {
    const double x = v.x - drop.pose.t.x, y = v.y - drop.pose.t.y;
    if (x * x + y * y < 1.5 || ground.vertices.size() < 100) highest = std::max(highest, double{v.z});
  }
  drop.pose.t.z = highest - lowest + clearance;
  return drop;
}

}  // namespace otg::test
