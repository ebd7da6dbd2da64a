// SPDX-License-Identifier: BSD-3-Clause
#include "truth/family_fall.h"

#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <cstdarg>
#include <random>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/vectors.h"
#include "truth/body_in_ode.h"

namespace otg::truth {
namespace {

constexpr double kGravity = 9.81;  // sizes per second squared
constexpr double kTilt = 0.4;      // of gravity, from the way in
constexpr double kGone = 40;       // sizes from where it began
constexpr double kSpeed = 1;       // sizes per second across the way in
// How far out of its host a mover begins, in sizes: the first at which it meets nothing.
constexpr double kDrops[] = {0.2, 0.1, 0.05, 0.02, 0.01}, kJustOut[] = {0.001};
constexpr int kPlaces = 64;

Vec3d of(const dReal* v) {
  return {v[0], v[1], v[2]};
}

/// Mass 1 and uniform density, about the centre of mass. `center`: of mass, in the mesh's frame.
dMass massOf(const scenes::MeshArrays& mesh, Vec3d& center) {
  dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  int status =
      dGpuTriMeshDataBuildSingle(data, mesh.vertices.data(), sizeof(Vec3f), static_cast<int>(mesh.vertices.size()),
                                 mesh.triangles.data(), static_cast<int>(3 * mesh.triangles.size()), sizeof(Triangle));
  dMass mass;
  if (status == dGPUTRIMESH_OK) status = dMassSetGpuTriMeshDataTotal(&mass, 1, data);
  dGpuTriMeshDataDestroy(data);
  if (status != dGPUTRIMESH_OK) throw std::runtime_error("the library refuses a mesh");
  center = of(mass.c);
  dMassTranslate(&mass, -center.x, -center.y, -center.z);
  std::fill(mass.c, mass.c + 3, dReal{0});
  return mass;
}

/// ODE's dTriMesh stops the program where many vertices are of no triangle.
void dropUnusedVertices(scenes::MeshArrays& mesh) {
  constexpr std::uint32_t kUnused = ~0U;
  std::vector<std::uint32_t> place(mesh.vertices.size(), kUnused);
  std::vector<Vec3f> used;
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle.v) {
      if (place[v] == kUnused) {
        place[v] = static_cast<std::uint32_t>(used.size());
        used.push_back(mesh.vertices[v]);
      }
      v = place[v];
    }
  }
  mesh.vertices = std::move(used);
}

class FallingMover {
 public:
  FallingMover(const CertificateMember& member, const FallConditions& conditions)
      : conditions_(conditions),
        size_(member.size),
        world_(dWorldCreate()),
        contacts_(dJointGroupCreate(0)),
        host_(member.a, {.asTriMesh = conditions.asTriMesh, .remembers = true}),
        mover_(member.b, {.asTriMesh = conditions.asTriMesh, .remembers = true}) {
    std::mt19937 random(conditions.seed);
    std::uniform_real_distribution<double> within(-1, 1);
    const double x = within(random), y = within(random), z = within(random);
    gravity_ = unit(unit(member.shortest) + Vec3d{x, y, z} * kTilt) * (kGravity * size_);
    friction_ = 0.5 + 0.4 * within(random);
    dRandSetSeed(conditions.seed);  // by which dWorldQuickStep orders what it solves
    dWorldSetGravity(world_, gravity_.x, gravity_.y, gravity_.z);
    dWorldSetQuickStepNumIterations(world_, 50);
    Vec3d center{};
    mass_ = massOf(member.b.mesh, center);
    body_ = dBodyCreate(world_);
    dBodySetMass(body_, &mass_);
    start_ = otgTransform(member.b.pose, center);
    dBodySetPosition(body_, start_.x, start_.y, start_.z);
    dBodySetRotation(body_, dGeomGetRotation(mover_.geom()));
    dGeomSetBody(mover_.geom(), body_);
    dGeomSetOffsetPosition(mover_.geom(), -center.x, -center.y, -center.z);
    const Vec3d way = unit(member.shortest);  // of the host out of the mover
    if (conditions.start == FallStart::kDropped) beginOutside(member.shortest, way, kDrops);
    if (conditions.start == FallStart::kSlid) {
      beginOutside(member.shortest, way, kJustOut);
      const Vec3d across = otgSub(Vec3d{x, y, z}, otgScale(way, otgDot(way, {x, y, z})));
      const Vec3d velocity = unit(across) * (kSpeed * size_);
      dBodySetLinearVel(body_, velocity.x, velocity.y, velocity.z);
    }
  }
  ~FallingMover() {
    dGeomSetBody(mover_.geom(), nullptr);
    dJointGroupDestroy(contacts_);
    dWorldDestroy(world_);
  }
  FallingMover(const FallingMover&) = delete;
  FallingMover& operator=(const FallingMover&) = delete;

  Fall run() {
    Fall fall;
    double before = energy();
    const int steps = static_cast<int>(conditions_.duration / conditions_.timeStep);
    for (int k = 0; k < steps && norm(of(dBodyGetPosition(body_)) - start_) < kGone * size_; ++k) {
      fall.depth = std::max(fall.depth, step() / size_);
      const double now = energy(), gain = (now - before) / (kGravity * size_ * size_);
      if (gain > fall.gain) {
        fall.gain = gain;
        fall.step = k;
      }
      before = now;
    }
    return fall;
  }

 private:
  /// The mover is where it begins without an overlap. Where it meets other parts of its host at all distances it is as
  /// far out as at the last.
  void beginOutside(const Vec3d& shortest, const Vec3d& way, std::span<const double> distances) {
    const Vec3d inside = start_;
    for (const double distance : distances) {
      start_ = inside - shortest - way * (distance * size_);
      dBodySetPosition(body_, start_.x, start_.y, start_.z);
      dContactGeom found[kPlaces];
      if (dCollide(host_.geom(), mover_.geom(), kPlaces, found, sizeof(dContactGeom)) == 0) return;
    }
  }

  /// Depth of the deepest contact.
  double step() {
    dContactGeom found[kPlaces];
    const int count = dCollide(host_.geom(), mover_.geom(), kPlaces, found, sizeof(dContactGeom));
    double deepest = 0;
    for (int i = 0; i < count; ++i) {
      dContact contact{};
      contact.geom = found[i];
      contact.surface.mode = dContactApprox1;
      contact.surface.mu = friction_;
      deepest = std::max(deepest, double{found[i].depth});
      dJointAttach(dJointCreateContact(world_, contacts_, &contact), dGeomGetBody(found[i].g1),
                   dGeomGetBody(found[i].g2));
    }
    (conditions_.quick ? dWorldQuickStep : dWorldStep)(world_, conditions_.timeStep);
    dJointGroupEmpty(contacts_);
    return deepest;
  }

  double energy() const {
    const Vec3d v = of(dBodyGetLinearVel(body_)), moved = of(dBodyGetPosition(body_)) - start_;
    dVector3 spin;  // in the body's frame
    const dReal* w = dBodyGetAngularVel(body_);
    dBodyVectorFromWorld(body_, w[0], w[1], w[2], spin);
    double rotation = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) rotation += spin[i] * mass_.I[4 * i + j] * spin[j];
    }
    return 0.5 * (otgDot(v, v) + rotation) - otgDot(gravity_, moved);
  }

  const FallConditions conditions_;
  const double size_;
  dWorldID world_;
  dJointGroupID contacts_;
  BodyInOde host_, mover_;
  dBodyID body_ = nullptr;
  dMass mass_{};
  Vec3d gravity_{}, start_{};
  double friction_ = 0;
};

}  // namespace

double thrownFrom(double timeStep) {
  constexpr double kErp = 0.2, kOverlap = 0.01;  // dWorldGetERP() by default; in sizes
  const auto pushedOut = [](double step) {
    const double speed = kErp * kOverlap / step;
    return 0.5 * speed * speed / kGravity;
  };
  return kThrown + std::max(0.0, pushedOut(timeStep) - pushedOut(1.0 / 240));
}

FallConditions fallConditions(int number) {
  FallConditions conditions;
  conditions.timeStep = number % 2 == 1 ? 1.0 / 60 : 1.0 / 240;
  conditions.quick = number / 2 % 2 == 1;
  conditions.seed = static_cast<std::uint32_t>(number);
  return conditions;
}

std::optional<CertificateMember> withOpenHost(const CertificateMember& member) {
  const scenes::MeshArrays& host = member.a.mesh;
  if (member.a.shape || host.vertices.empty()) return {};
  const auto inSide = [](const Vec3f& v, int side, const Vec3f& low, const Vec3f& high) {
    const float at[3] = {v.x, v.y, v.z}, lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z};
    const float slack = 1e-4F * (highs[side / 2] - lows[side / 2]);
    return side % 2 == 0 ? at[side / 2] <= lows[side / 2] + slack : at[side / 2] >= highs[side / 2] - slack;
  };
  Vec3f low = host.vertices[0], high = low;
  for (const Vec3f& v : host.vertices) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  CertificateMember open = member;
  std::erase_if(open.a.mesh.triangles, [&](const Triangle& t) {
    for (int side = 0; side < 6; ++side) {
      if (std::all_of(t.v, t.v + 3, [&](std::uint32_t v) { return inSide(host.vertices[v], side, low, high); })) {
        return true;
      }
    }
    return false;
  });
  const std::size_t left = open.a.mesh.triangles.size();
  if (left == 0 || left == host.triangles.size()) return {};
  dropUnusedVertices(open.a.mesh);
  open.what += "; the host is open";
  return open;
}

Fall fall(const CertificateMember& member, const FallConditions& conditions) {
  // Of jammed bodies dWorldStep() says at every step that its solver has found no solution.
  dMessageFunction* const handler = dGetMessageHandler();
  dSetMessageHandler([](int, const char*, va_list) {});
  const Fall result = FallingMover(member, conditions).run();
  dSetMessageHandler(handler);
  return result;
}

}  // namespace otg::truth
