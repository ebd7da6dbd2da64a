// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/simulation.h"

#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include "base/vectors.h"

namespace otg::scenes {
namespace {

double millisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

bool isGpuTriMesh(const BodyDescription& body) {
  return body.collider == Collider::kGpuTriMesh;
}

dSpaceID makeSpace(const SceneDescription& scene) {
  switch (scene.space) {
    case SpaceKind::kSimple:
      return dSimpleSpaceCreate(nullptr);
    case SpaceKind::kSap:
      return dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ);
    case SpaceKind::kQuadTree: {
      // The root block has to hold the scene at its start; what leaves it is still found, only more slowly.
      double reach = 1;
      for (const BodyDescription& body : scene.bodies) {
        double radius = body.size.x + body.size.y + body.size.z;
        if (body.heights) radius = body.heights->sizeX + body.heights->sizeY;
        if (body.mesh) {
          const Vec3f c = body.mesh->center();
          radius = body.mesh->radius() + std::sqrt(double(otgDot(c, c)));
        }
        for (const double x : {body.position.x, body.position.y, body.position.z}) {
          reach = std::max(reach, std::fabs(x) + radius);
        }
      }
      const dVector3 center{0, 0, 0, 0};
      const dVector3 extents{2 * reach, 2 * reach, 2 * reach, 0};
      return dQuadTreeSpaceCreate(nullptr, center, extents, 5);
    }
    case SpaceKind::kHash:
      break;
  }
  return dHashSpaceCreate(nullptr);
}

Transformd poseOf(const BodyDescription& description) {
  const dQuaternion q{description.rotation[0], description.rotation[1], description.rotation[2],
                      description.rotation[3]};
  dMatrix3 r;
  dQtoR(q, r);
  return {{r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10]}, description.position};
}

/// The body that a geom stands for: makeGeom()'s caller leaves its number + 1, and a plane has nothing.
std::size_t numberOf(dGeomID geom) {
  return reinterpret_cast<std::uintptr_t>(dGeomGetData(geom)) - 1;
}

/// What ODE calls where it can go on no more. It would abort.
void endProgram(int, const char* message, va_list arguments) {
  std::fputs("otg: ODE cannot go on: ", stderr);
  std::vfprintf(stderr, message, arguments);
  std::fputc('\n', stderr);
  std::_Exit(1);
}

}  // namespace

OdeSession::OdeSession() {
  dInitODE2(0);
  dSetErrorHandler(&endProgram);
  dSetDebugHandler(&endProgram);
  dAllocateODEDataForThread(dAllocateMaskAll);
  if (dGpuTriMeshInit() == 0) {
    const int status = dGpuTriMeshGetError();
    dCloseODE();
    throw std::runtime_error(dGpuTriMeshErrorString(status));
  }
}

OdeSession::~OdeSession() {
  dGpuTriMeshClose();
  dSetErrorHandler(nullptr);
  dSetDebugHandler(nullptr);
  dCloseODE();
}

Simulation::Simulation(const SceneDescription& scene) : scene_(scene), randomState_(scene.seed) {
  try {
    world_ = dWorldCreate();
    dWorldSetGravity(world_, scene_.gravity.x, scene_.gravity.y, scene_.gravity.z);
    dWorldSetERP(world_, scene_.erp);
    dWorldSetCFM(world_, scene_.cfm);
    dWorldSetQuickStepNumIterations(world_, scene_.iterations);
    dWorldSetContactSurfaceLayer(world_, scene_.surfaceLayer);
    dWorldSetContactMaxCorrectingVel(world_, std::min(scene_.maxCorrectingVelocity, double(dInfinity)));
    dWorldSetLinearDamping(world_, scene_.linearDamping);
    dWorldSetAngularDamping(world_, scene_.angularDamping);
    space_ = makeSpace(scene_);
    contactJoints_ = dJointGroupCreate(0);
    contacts_.resize(static_cast<std::size_t>(scene_.maxContacts));
    for (const PlaneDescription& plane : scene_.planes) {
      dCreatePlane(space_, plane.normal.x, plane.normal.y, plane.normal.z, plane.offset);
    }
    for (const BodyDescription& description : scene_.bodies) addBody(description);
    checkPlaces();
  } catch (...) {
    clear();
    throw;
  }
}

Simulation::~Simulation() {
  clear();
}

void Simulation::clear() {
  if (contactJoints_ != nullptr) dJointGroupDestroy(contactJoints_);
  if (space_ != nullptr) dSpaceDestroy(space_);  // with its geoms
  for (const Body& body : bodies_) {
    if (body.odeData != nullptr) dGeomTriMeshDataDestroy(body.odeData);
  }
  if (world_ != nullptr) dWorldDestroy(world_);
}

dGeomID Simulation::makeGeom(const BodyDescription& description, Body& body) const {
  const Vec3d& s = description.size;
  if (description.collider == Collider::kPrimitive) {
    switch (description.shape) {
      case ShapeKind::kHeightfield:
        body.heights = std::make_unique<HeightfieldData>(*description.heights);
        return body.heights->makeGeom(space_, poseOf(description));
      case ShapeKind::kBox:
        return dCreateBox(space_, s.x, s.y, s.z);
      case ShapeKind::kSphere:
        return dCreateSphere(space_, s.x);
      case ShapeKind::kCylinder:
        return dCreateCylinder(space_, s.x, s.y);
      default:
        return dCreateCapsule(space_, s.x, s.y);
    }
  }
  const TriMesh& mesh = *description.mesh;
  const auto vertexCount = static_cast<int>(mesh.vertices().size());
  const auto indexCount = static_cast<int>(3 * mesh.triangleCount());
  if (description.collider == Collider::kOdeTriMesh) {
    body.odeData = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildSingle(body.odeData, mesh.vertices().data(), sizeof(Vec3f), vertexCount,
                                mesh.triangles().data(), indexCount, sizeof(Triangle));
    return dCreateTriMesh(space_, body.odeData, nullptr, nullptr, nullptr);
  }
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  if (data == nullptr) throw std::bad_alloc();
  const int status = dGpuTriMeshDataBuildSingle(data, mesh.vertices().data(), sizeof(Vec3f), vertexCount,
                                                mesh.triangles().data(), indexCount, sizeof(Triangle));
  if (status < 0) {
    const std::string why = dGpuTriMeshDataGetErrorString(data);
    dGpuTriMeshDataDestroy(data);
    throw SceneError("body '" + description.name + "': " + why);
  }
  const dGeomID geom = dCreateGpuTriMesh(space_, data);
  dGpuTriMeshDataDestroy(data);  // the geom keeps the mesh
  if (geom == nullptr) throw SceneError("body '" + description.name + "': the geom could not be created");
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  params.contacts_per_region = scene_.contactsPerRegion;
  params.region_merge = static_cast<dReal>(scene_.regionMerge);
  params.history = scene_.history ? dGPUTRIMESH_HISTORY_ON : dGPUTRIMESH_HISTORY_OFF;
  if (dGeomGpuTriMeshSetParams(geom, &params) != dGPUTRIMESH_OK) {
    throw SceneError("the number of contacts for each region must be 1 to 64, and region_merge a length");
  }
  return geom;
}

void Simulation::addBody(const BodyDescription& description) {
  Body& body = bodies_.emplace_back();
  body.geom = makeGeom(description, body);
  // The index finds the description again in the near callback.
  dGeomSetData(body.geom, reinterpret_cast<void*>(bodies_.size()));
  dQuaternion q{description.rotation[0], description.rotation[1], description.rotation[2], description.rotation[3]};
  const Vec3d& p = description.position;
  if (body.heights) return;
  if (description.isStatic) {
    dGeomSetPosition(body.geom, p.x, p.y, p.z);
    dGeomSetQuaternion(body.geom, q);
    return;
  }
  dMass mass;
  Vec3d center;
  bodyMass(description, mass, center);
  body.body = dBodyCreate(world_);
  dBodySetMass(body.body, &mass);
  // ODE wants the centre of mass at the body's origin: the geom is offset instead.
  dGeomSetBody(body.geom, body.body);
  if (center != Vec3d{0, 0, 0}) dGeomSetOffsetPosition(body.geom, -center.x, -center.y, -center.z);
  dBodySetQuaternion(body.body, q);
  dVector3 shift;
  dBodyVectorToWorld(body.body, center.x, center.y, center.z, shift);
  dBodySetPosition(body.body, p.x + shift[0], p.y + shift[1], p.z + shift[2]);
  const Vec3d &v = description.linearVelocity, &w = description.angularVelocity;
  dBodySetLinearVel(body.body, v.x, v.y, v.z);
  dBodySetAngularVel(body.body, w.x, w.y, w.z);
}

void Simulation::checkPlaces() const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const BodyState now = state(i);
    double place = 0, sum = 0;
    for (const double x : {now.position.x, now.position.y, now.position.z}) place = std::max(place, std::fabs(x));
    for (const Vec3d& v : {now.position, now.linearVelocity, now.angularVelocity}) sum += v.x + v.y + v.z;
    for (const double x : now.rotation) sum += x;
    // A mesh may be far from its own origin. What is large is in no cell.
    dReal box[6];
    dGeomGetAABB(bodies_[i].geom, box);
    for (int k = 0; k < 3; ++k) {
      if (box[2 * k + 1] - box[2 * k] > 1e6) continue;
      for (const double x : {box[2 * k], box[2 * k + 1]}) place = std::max(place, std::fabs(x) - 1e6);
    }
    if (place <= kFarthest && std::isfinite(sum)) continue;
    const std::string when = steps_ == 0 ? "at the start" : "after step " + std::to_string(steps_);
    char why[80];
    std::snprintf(why, sizeof why, "is more than %g m from the origin", kFarthest);
    throw SceneError("body '" + scene_.bodies[i].name + "' " +
                     (std::isfinite(sum) ? why : "moves by numbers that are not finite") + " " + when);
  }
}

void Simulation::nearCallback(void* self, dGeomID a, dGeomID b) {
  static_cast<Simulation*>(self)->collidePair(a, b);
}

void Simulation::collidePair(dGeomID a, dGeomID b) {
  const dBodyID bodyA = dGeomGetBody(a), bodyB = dGeomGetBody(b);
  if (bodyA == nullptr && bodyB == nullptr) return;
  const int count = dCollide(a, b, scene_.maxContacts, &contacts_[0].geom, sizeof(dContact));
  double mu = scene_.mu, bounce = scene_.bounce;
  bool ours = true;
  for (const dGeomID geom : {a, b}) {
    const auto index = reinterpret_cast<std::uintptr_t>(dGeomGetData(geom));  // 0 for a plane
    if (index == 0) {
      ours = false;
      continue;
    }
    const BodyDescription& description = scene_.bodies[index - 1];
    ours = ours && isGpuTriMesh(description);
    if (description.mu) mu = std::min(mu, *description.mu);
    if (description.bounce) bounce = std::max(bounce, *description.bounce);
  }
  for (int i = 0; i < count; ++i) {
    dContact& contact = contacts_[static_cast<std::size_t>(i)];
    contact.surface = {};
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = std::isinf(mu) ? dInfinity : mu;
    if (bounce > 0) {
      contact.surface.mode |= dContactBounce;
      contact.surface.bounce = bounce;
      contact.surface.bounce_vel = scene_.bounceVelocity;
    }
    dJointAttach(dJointCreateContact(world_, contactJoints_, &contact), bodyA, bodyB);
    const dContactGeom& found = contact.geom;
    stepContacts_.push_back({{found.pos[0], found.pos[1], found.pos[2]},
                             {found.normal[0], found.normal[1], found.normal[2]},
                             found.depth,
                             numberOf(found.g1),
                             numberOf(found.g2)});
  }
  contactCount_ += count;
  if (!ours) contactsOfOthers_ += count;
}

Simulation::Found Simulation::foundSoFar() const {
  Found sum;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!isGpuTriMesh(scene_.bodies[i])) continue;
    dGpuTriMeshStats stats;
    dGpuTriMeshStatsInit(&stats);
    if (dGeomGpuTriMeshGetStats(bodies_[i].geom, &stats) != dGPUTRIMESH_OK) continue;
    sum.contacts += stats.contacts_before_reduction;
    sum.intersectingPairs += stats.intersecting_pairs;
  }
  return {sum.contacts / 2, sum.intersectingPairs / 2};  // a pair of geoms counts for both
}

StepRecord Simulation::step(double dt) {
  StepRecord record;
  contactCount_ = 0;
  contactsOfOthers_ = 0;
  stepContacts_.clear();
  const Found before = foundSoFar();
  dRandSetSeed(randomState_);
  auto start = std::chrono::steady_clock::now();
  if (prefetch_) dGpuTriMeshPrefetch(space_);
  dSpaceCollide(space_, this, &nearCallback);
  record.collideMs = millisecondsSince(start);
  start = std::chrono::steady_clock::now();
  if (scene_.stepper == Stepper::kQuick)
    dWorldQuickStep(world_, dt);
  else
    dWorldStep(world_, dt);
  record.stepMs = millisecondsSince(start);
  ++steps_;
  checkPlaces();
  randomState_ = dRandGetSeed();
  dJointGroupEmpty(contactJoints_);
  record.contacts = contactCount_;
  const Found after = foundSoFar();
  record.contactsBeforeReduction =
      after.contacts - before.contacts + static_cast<std::uint64_t>(std::max(contactsOfOthers_, 0));
  record.intersectingPairs = after.intersectingPairs - before.intersectingPairs;
  return record;
}

BodyState Simulation::state(std::size_t index) const {
  const Body& body = bodies_[index];
  BodyState state;
  const dReal* p = dGeomGetPosition(body.geom);
  state.position = {p[0], p[1], p[2]};
  state.centerOfMass = state.position;
  dQuaternion q;
  dGeomGetQuaternion(body.geom, q);
  if (body.heights) std::copy(scene_.bodies[index].rotation, scene_.bodies[index].rotation + 4, q);  // not ODE's axes
  std::copy(q, q + 4, state.rotation.begin());
  if (body.body != nullptr) {
    const dReal *c = dBodyGetPosition(body.body), *v = dBodyGetLinearVel(body.body), *w = dBodyGetAngularVel(body.body);
    state.centerOfMass = {c[0], c[1], c[2]};
    state.linearVelocity = {v[0], v[1], v[2]};
    state.angularVelocity = {w[0], w[1], w[2]};
  }
  return state;
}

Energy Simulation::energy() const {
  Energy energy;
  for (const Body& body : bodies_) {
    if (body.body == nullptr) continue;
    dMass mass;
    dBodyGetMass(body.body, &mass);
    const dReal *x = dBodyGetPosition(body.body), *v = dBodyGetLinearVel(body.body),
                *omega = dBodyGetAngularVel(body.body);
    dVector3 w;  // the inertia tensor is in the body's frame
    dBodyVectorFromWorld(body.body, omega[0], omega[1], omega[2], w);
    energy.kinetic += 0.5 * mass.mass * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; ++i) {
      const dReal* row = mass.I + 4 * i;
      energy.kinetic += 0.5 * w[i] * (row[0] * w[0] + row[1] * w[1] + row[2] * w[2]);
    }
    energy.potential -= mass.mass * (scene_.gravity.x * x[0] + scene_.gravity.y * x[1] + scene_.gravity.z * x[2]);
  }
  return energy;
}

Vec3d Simulation::linearMomentum() const {
  Vec3d sum{0, 0, 0};
  for (const Body& body : bodies_) {
    if (body.body == nullptr) continue;
    dMass mass;
    dBodyGetMass(body.body, &mass);
    const dReal* v = dBodyGetLinearVel(body.body);
    sum = sum + Vec3d{v[0], v[1], v[2]} * double(mass.mass);
  }
  return sum;
}

}  // namespace otg::scenes
