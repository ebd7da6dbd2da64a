// SPDX-License-Identifier: BSD-3-Clause
// Building and stepping the world of one run.
#include "physics/rig.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>

#include "base/hash.h"
#include "ode_trimesh_gpu/ode_trimesh_gpu.h"

namespace otg::physics {
namespace {

/// Where "1e5 m away" is: all three coordinates differ and none is a round number in binary.
const Vec kPlaceDirection = Vec(0.7123, -0.4871, 0.5054).normalized();

double milliseconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double, std::milli>(d).count();
}

Vec toVec(const dReal* v) {
  return {v[0], v[1], v[2]};
}

Rotation toRotation(const dReal* q) {
  return {q[0], q[1], q[2], q[3]};
}

void setQuaternion(dQuaternion out, const Rotation& q) {
  out[0] = q.w();
  out[1] = q.x();
  out[2] = q.y();
  out[3] = q.z();
}

}  // namespace

OdeSession::OdeSession() {
  dInitODE2(0);
  dAllocateODEDataForThread(dAllocateMaskAll);
  if (!dGpuTriMeshInit()) throw std::runtime_error(dGpuTriMeshErrorString(dGpuTriMeshGetError()));
}

OdeSession::~OdeSession() {
  dGpuTriMeshClose();
  dCloseODE();
}

/// The arrays of a shape at the size of the run, and what ODE or the library made of them.
struct Rig::ScaledMesh {
  std::vector<Vec3f> vertices;  // ODE keeps pointers to these
  std::vector<Triangle> triangles;
  dTriMeshDataID stock = nullptr;
  dGpuTriMeshDataID ours = nullptr;

  ScaledMesh(const scenes::MeshArrays& mesh, double size) : vertices(mesh.vertices), triangles(mesh.triangles) {
    for (Vec3f& v : vertices)
      v = {static_cast<float>(size * v.x), static_cast<float>(size * v.y), static_cast<float>(size * v.z)};
  }
  ScaledMesh(const ScaledMesh&) = delete;
  ScaledMesh& operator=(const ScaledMesh&) = delete;
  ~ScaledMesh() {
    if (stock) dGeomTriMeshDataDestroy(stock);
    dGpuTriMeshDataDestroy(ours);
  }

  dGeomID makeStock(dSpaceID space) {
    if (!stock) {
      stock = dGeomTriMeshDataCreate();
      dGeomTriMeshDataBuildSingle(stock, vertices.data(), sizeof(Vec3f), static_cast<int>(vertices.size()),
                                  triangles.data(), static_cast<int>(3 * triangles.size()), sizeof(Triangle));
    }
    return dCreateTriMesh(space, stock, nullptr, nullptr, nullptr);
  }

  dGeomID makeOurs(dSpaceID space, Model model) {
    if (!ours) {
      ours = dGpuTriMeshDataCreate();
      if (dGpuTriMeshDataBuildSingle(ours, vertices.data(), 0, static_cast<int>(vertices.size()), triangles.data(),
                                     static_cast<int>(3 * triangles.size()), 0) != dGPUTRIMESH_OK)
        throw std::runtime_error(dGpuTriMeshDataGetErrorString(ours));
    }
    const dGeomID geom = dCreateGpuTriMesh(space, ours);
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    params.contact_model = static_cast<int>(model);
    if (!geom || dGeomGpuTriMeshSetParams(geom, &params) != dGPUTRIMESH_OK)
      throw std::runtime_error(dGpuTriMeshErrorString(dGpuTriMeshGetError()));
    return geom;
  }
};

Rig::Rig(const Case& run, const RigOptions& options)
    : run_(run),
      options_(options),
      place_(run.offset * kPlaceDirection),
      speedUnit_(run.fullGravity ? std::sqrt(run.size) : run.size),
      energyUnit_(speedUnit_ * speedUnit_),
      world_(dWorldCreate()),
      space_(dSimpleSpaceCreate(nullptr)),
      contactJoints_(dJointGroupCreate(0)),
      buffer_(static_cast<std::size_t>(run.buffer)) {
  const Vec gravity = options.gravity * (run.fullGravity ? 1 : run.size);
  dWorldSetGravity(world_, gravity.x(), gravity.y(), gravity.z());
  dWorldSetERP(world_, 0.2);
  dWorldSetCFM(world_, 1e-5);
  dWorldSetQuickStepNumIterations(world_, run.stepping.iterations);
  dRandSetSeed(run.randomSeed);
}

Rig::~Rig() {
  dJointGroupDestroy(contactJoints_);
  dSpaceDestroy(space_);
  dWorldDestroy(world_);
}

int Rig::addBody(ShapePointer shape, const Vec& position, const Rotation& rotation) {
  Body body{dBodyCreate(world_), position, rotation, {}, shape->extent};
  const Eigen::Matrix3d inertia = shape->inertia * (run_.size * run_.size);
  dMassSetParameters(&body.mass, 1, 0, 0, 0, inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(0, 2),
                     inertia(1, 2));
  dBodySetMass(body.id, &body.mass);
  const Vec p = toWorld(position);
  dBodySetPosition(body.id, p.x(), p.y(), p.z());
  dQuaternion q;
  setQuaternion(q, rotation);
  dBodySetQuaternion(body.id, q);
  smallestExtent_ = bodies_.empty() ? shape->extent : std::min(smallestExtent_, shape->extent);
  items_.push_back({std::move(shape), position, rotation, bodyCount()});
  bodies_.push_back(body);
  return bodyCount() - 1;
}

void Rig::addStatic(ShapePointer shape, const Vec& position, const Rotation& rotation) {
  items_.push_back({std::move(shape), position, rotation, -1});
}

void Rig::setVelocity(int body, const Vec& linear, const Vec& angular) {
  const Vec v = speedUnit_ * linear, w = speedUnit_ / run_.size * angular;
  dBodySetLinearVel(bodies_[body].id, v.x(), v.y(), v.z());
  dBodySetAngularVel(bodies_[body].id, w.x(), w.y(), w.z());
}

void Rig::addMotor(int body, const Vec& axis, double speed, double torque) {
  const dJointID joint = dJointCreateHinge(world_, nullptr);
  dJointAttach(joint, bodies_[body].id, nullptr);
  const Vec p = toWorld(bodies_[body].position);
  dJointSetHingeAnchor(joint, p.x(), p.y(), p.z());
  dJointSetHingeAxis(joint, axis.x(), axis.y(), axis.z());
  dJointSetHingeParam(joint, dParamVel, speed * speedUnit_ / run_.size);
  dJointSetHingeParam(joint, dParamFMax, torque * energyUnit_);
  // CFM of a torque is rad/s per N m: unlike that of a force it has to be scaled for the scene to be similar.
  dJointSetHingeParam(joint, dParamCFM, 1e-5 / (run_.size * run_.size));
  std::unique_ptr<Motor>& motor = motors_[body];
  motor = std::make_unique<Motor>();
  motor->joint = joint;
  dJointSetFeedback(joint, &motor->feedback);
}

double Rig::motorTorque(int body) const {
  const Motor& motor = *motors_.at(body);
  dVector3 axis;
  dJointGetHingeAxis(motor.joint, axis);
  return toVec(motor.feedback.t1).dot(toVec(axis)) / energyUnit_;
}

void Rig::makeGeoms() {
  built_ = true;
  if (run_.order == Order::kReversed)
    for (auto item = items_.rbegin(); item != items_.rend(); ++item) makeGeomsOf(*item);
  else
    for (const Item& item : items_) makeGeomsOf(item);
  startEnergy_ = lowestEnergy_ = energy();
  for (int i = 0; i < bodyCount(); ++i) lastSpeed_ = std::max(lastSpeed_, fastestPoint(i));
}

void Rig::makeGeomsOf(const Item& item) {
  const auto scaled = [&]() -> ScaledMesh& {
    std::unique_ptr<ScaledMesh>& mesh = meshes_[item.shape.get()];
    if (!mesh) mesh = std::make_unique<ScaledMesh>(item.shape->mesh, run_.size);
    return *mesh;
  };
  if (run_.form != Form::kNative && !(options_.bodiesAreShapes && item.body >= 0)) {
    place(run_.form == Form::kStock ? scaled().makeStock(space_) : scaled().makeOurs(space_, run_.model), item, {});
    return;
  }
  if (item.shape->native.empty()) throw std::runtime_error("the scene has no native form");
  for (const NativeGeom& native : item.shape->native) {
    const Vec size = run_.size * native.size;
    switch (native.kind) {
      case NativeGeom::Kind::kBox:
        place(dCreateBox(space_, size.x(), size.y(), size.z()), item, native);
        break;
      case NativeGeom::Kind::kSphere:
        place(dCreateSphere(space_, size.x()), item, native);
        break;
      case NativeGeom::Kind::kCylinder:
        place(dCreateCylinder(space_, size.x(), size.z()), item, native);
        break;
      case NativeGeom::Kind::kCapsule:
        place(dCreateCapsule(space_, size.x(), size.z()), item, native);
        break;
      case NativeGeom::Kind::kPlane: {
        const Vec n = item.rotation * Vec::UnitZ();
        dCreatePlane(space_, n.x(), n.y(), n.z(), n.dot(toWorld(item.position)));
        break;
      }
      case NativeGeom::Kind::kTriMesh:
        place(scaled().makeStock(space_), item, {});
        break;
    }
  }
}

void Rig::place(dGeomID geom, const Item& item, const NativeGeom& native) {
  const Vec& center = native.center;
  dQuaternion q;
  if (item.body >= 0) {
    dGeomSetBody(geom, bodies_[item.body].id);
    if (!center.isZero())
      dGeomSetOffsetPosition(geom, run_.size * center.x(), run_.size * center.y(), run_.size * center.z());
    if (native.rotation.w() != 1) {
      setQuaternion(q, native.rotation);
      dGeomSetOffsetQuaternion(geom, q);
    }
    return;
  }
  const Vec p = toWorld(item.position + item.rotation * center);
  dGeomSetPosition(geom, p.x(), p.y(), p.z());
  setQuaternion(q, item.rotation * native.rotation);
  dGeomSetQuaternion(geom, q);
}

void Rig::nearCallback(void* self, dGeomID a, dGeomID b) {
  static_cast<Rig*>(self)->collidePair(a, b);
}

void Rig::collidePair(dGeomID a, dGeomID b) {
  if (!dGeomGetBody(a) && !dGeomGetBody(b)) return;
  if (run_.order == Order::kSwapped) std::swap(a, b);
  const int count = dCollide(a, b, run_.buffer, &buffer_[0].geom, sizeof(dContact));
  for (int i = 0; i < count; ++i) {
    dContact& contact = buffer_[static_cast<std::size_t>(i)];
    stepDepth_ = std::max(stepDepth_, contact.geom.depth / run_.size);
    if (collect_) {
      const double sign = contact.geom.g1 == a ? 1 : -1;
      collect_->push_back({(toVec(contact.geom.pos) - place_) / run_.size, sign * toVec(contact.geom.normal),
                           contact.geom.depth / run_.size});
      continue;
    }
    contact.surface = {};
    // The pyramid is bound to the normal force; otherwise mu is a force and a slope has no meaning.
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = options_.mu;
    if (options_.bounce > 0) {
      contact.surface.mode |= dContactBounce;
      contact.surface.bounce = options_.bounce;
      contact.surface.bounce_vel = 0.01 * speedUnit_;
    }
    const dJointID joint = dJointCreateContact(world_, contactJoints_, &contact);
    dJointAttach(joint, dGeomGetBody(contact.geom.g1), dGeomGetBody(contact.geom.g2));
  }
  contacts_ += count;
}

bool Rig::step() {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  dSpaceCollide(space_, this, &nearCallback);
  const Clock::time_point collided = Clock::now();
  if (run_.stepping.stepper == Stepper::kWorld)
    dWorldStep(world_, run_.dt);
  else
    dWorldQuickStep(world_, run_.dt);
  dJointGroupEmpty(contactJoints_);
  const Clock::time_point end = Clock::now();
  collideMs_ += milliseconds(collided - start);
  stepMs_ += milliseconds(end - start);
  ++steps_;
  time_ += run_.dt;
  record();
  return finite_;
}

void Rig::record() {
  const double now = energy(), count = static_cast<double>(bodies_.size());
  // A step of the scene's own time: at full gravity time runs differently from size 1.
  const double sceneStep = run_.dt * speedUnit_ / run_.size;
  deepest_ = std::max(deepest_, stepDepth_);
  excess_ = std::max(excess_, stepDepth_ - 2 * lastSpeed_ * sceneStep);
  stepDepth_ = lastSpeed_ = 0;
  for (int i = 0; i < bodyCount(); ++i) {
    lastSpeed_ = std::max(lastSpeed_, fastestPoint(i));
    maxSpeed_ = std::max(maxSpeed_, velocity(i).norm());
  }
  // A body that is thrown that fast will not come back, and ODE aborts on positions that are not finite.
  finite_ = std::isfinite(now) && maxSpeed_ < 1e4;
  gain_ = std::max(gain_, (now - startEnergy_) / count);
  lowestEnergy_ = std::min(lowestEnergy_, now);
  rise_ = std::max(rise_, (now - lowestEnergy_) / count);
  kineticHistory_.push_back(kineticEnergy());
  energyHistory_.emplace_back(time_, (now - startEnergy_) / count);
}

void Rig::run(double seconds, const std::function<bool()>& each) {
  if (!built_) makeGeoms();
  const long steps = std::lround(seconds / run_.dt);
  for (long i = 0; i < steps && finite_; ++i)
    if (!step() || (each && !each())) return;
}

std::vector<Contact> Rig::contactsNow() {
  if (!built_) makeGeoms();
  std::vector<Contact> contacts;
  collect_ = &contacts;
  dSpaceCollide(space_, this, &nearCallback);
  collect_ = nullptr;
  return contacts;
}

Vec Rig::position(int body) const {
  return (toVec(dBodyGetPosition(bodies_[body].id)) - place_) / run_.size;
}

Rotation Rig::rotation(int body) const {
  return toRotation(dBodyGetQuaternion(bodies_[body].id));
}

Vec Rig::velocity(int body) const {
  return toVec(dBodyGetLinearVel(bodies_[body].id)) / speedUnit_;
}

Vec Rig::angularVelocity(int body) const {
  return toVec(dBodyGetAngularVel(bodies_[body].id)) * (run_.size / speedUnit_);
}

double Rig::fastestPoint(int body) const {
  return velocity(body).norm() + angularVelocity(body).norm() * bodies_[body].extent / 2;
}

double Rig::drift(int body) const {
  return (position(body) - bodies_[body].position).head<2>().norm();
}

double Rig::tilt(int body) const {
  const Vec now = rotation(body) * Vec::UnitZ(), start = bodies_[body].rotation * Vec::UnitZ();
  return std::atan2(now.cross(start).norm(), now.dot(start)) * 180 / std::numbers::pi;
}

double Rig::worstDrift() const {
  double worst = 0;
  for (int i = 0; i < bodyCount(); ++i) worst = std::max(worst, drift(i));
  return worst;
}

double Rig::worstTilt() const {
  double worst = 0;
  for (int i = 0; i < bodyCount(); ++i) worst = std::max(worst, tilt(i));
  return worst;
}

double Rig::kineticEnergy() const {
  double sum = 0;
  for (const Body& body : bodies_) {
    const Vec w = toRotation(dBodyGetQuaternion(body.id)).conjugate() * toVec(dBodyGetAngularVel(body.id));
    Eigen::Matrix3d inertia;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) inertia(r, c) = body.mass.I[4 * r + c];
    sum += 0.5 * (toVec(dBodyGetLinearVel(body.id)).squaredNorm() + w.dot(inertia * w));
  }
  return sum / energyUnit_;
}

double Rig::energy() const {
  // ODE moves with the velocity at the end of the step, so its velocities are those of half a step ago. With half a
  // step of gravity added, the energy of free flight is constant to the last bits; without, it falls by g^2 dt / 2
  // each second, which would hide what collisions add. Bodies at rest get a constant.
  dVector3 g;
  dWorldGetGravity(world_, g);
  const Vec gravity = toVec(g);
  double sum = 0;
  for (const Body& body : bodies_) {
    const Vec v = toVec(dBodyGetLinearVel(body.id)), x = toVec(dBodyGetPosition(body.id)) - place_;
    sum += 0.5 * ((v + 0.5 * run_.dt * gravity).squaredNorm() - v.squaredNorm()) - gravity.dot(x);
  }
  return sum / energyUnit_ + kineticEnergy();
}

Measures Rig::measures() const {
  Measures m;
  const std::size_t tail =
      std::min(kineticHistory_.size(), static_cast<std::size_t>(std::max(1L, std::lround(0.5 / run_.dt))));
  double ke = 0;
  for (std::size_t i = kineticHistory_.size() - tail; i < kineticHistory_.size(); ++i) ke += kineticHistory_[i];
  double settle = 0;
  for (int i = 0; i < bodyCount(); ++i) settle = std::max(settle, std::abs(position(i).z() - bodies_[i].position.z()));
  const double steps = static_cast<double>(std::max(1L, steps_));
  m["energy_gain"] = gain_;
  m["energy_rise"] = rise_;
  m["ke"] = tail ? ke / static_cast<double>(tail) : 0;
  m["deepest"] = deepest_ / smallestExtent_;
  m["depth_per_5ms"] = deepest_ / smallestExtent_ * (0.005 / run_.dt);
  m["excess_depth"] = excess_ / smallestExtent_;
  m["max_speed"] = maxSpeed_;
  m["settle"] = settle;
  m["finite"] = finite_ ? 1 : 0;
  m["contacts"] = static_cast<double>(contacts_) / steps;
  m["step_ms"] = stepMs_ / steps;
  m["collide_ms"] = collideMs_ / steps;
  return m;
}

std::uint64_t Rig::stateHash() const {
  std::uint64_t hash = kFnvStart;
  const auto add = [&](const dReal* values, int count) {
    hash = fnv1a(values, static_cast<std::size_t>(count) * sizeof(dReal), hash);
  };
  for (const Body& body : bodies_) {
    add(dBodyGetPosition(body.id), 3);
    add(dBodyGetQuaternion(body.id), 4);
    add(dBodyGetLinearVel(body.id), 3);
    add(dBodyGetAngularVel(body.id), 3);
  }
  return hash;
}

}  // namespace otg::physics
