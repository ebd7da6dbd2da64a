// SPDX-License-Identifier: BSD-3-Clause
#include "world.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "errors.h"
#include "geoms.h"
#include "scenes/scene_description.h"

namespace otg::python {
namespace {

/// ODE's random numbers, which its quick stepper uses, are the process's.
std::mutex random_numbers;

int numberOf(dGeomID geom) {
  return static_cast<int>(reinterpret_cast<std::uintptr_t>(dGeomGetData(geom)));
}

Transformd transformOf(const std::array<double, 16>& m) {
  return {{m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]}, {m[3], m[7], m[11]}};
}

std::array<double, 16> matrixOf(const dReal* r, const dReal* p) {
  return {r[0], r[1], r[2], p[0], r[4], r[5], r[6], p[1], r[8], r[9], r[10], p[2], 0, 0, 0, 1};
}

/// Mass of the density in the shape's frame.
dMass massOf(const Part& part, double density) {
  dMass mass;
  const auto& s = part.size;
  switch (part.kind) {
    case ShapeKind::kMesh:
      part.mesh->checkData(dMassSetGpuTriMeshData(&mass, density, part.mesh->data()), "the mass of a body");
      break;
    case ShapeKind::kBox:
      dMassSetBox(&mass, density, s[0], s[1], s[2]);
      break;
    case ShapeKind::kSphere:
      dMassSetSphere(&mass, density, s[0]);
      break;
    case ShapeKind::kCapsule:
      dMassSetCapsule(&mass, density, 3, s[0], s[1]);
      break;
    case ShapeKind::kCylinder:
      dMassSetCylinder(&mass, density, 3, s[0], s[1]);
      break;
    default:
      throw ArgumentError("planes and terrains can only be static");
  }
  return mass;
}

}  // namespace

std::array<double, 16> product(const std::array<double, 16>& a, const std::array<double, 16>& b) {
  std::array<double, 16> c{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t k = 0; k < 4; ++k) c[4 * i + j] += a[4 * i + k] * b[4 * k + j];
    }
  }
  return c;
}

World::World(const WorldSettings& settings) : randomState(settings.seed), settings_(settings) {
  prepareThread();
  world_ = dWorldCreate();
  dWorldSetGravity(world_, settings.gravity[0], settings.gravity[1], settings.gravity[2]);
  dWorldSetERP(world_, settings.erp);
  dWorldSetCFM(world_, settings.cfm);
  dWorldSetQuickStepNumIterations(world_, settings.iterations);
  dWorldSetContactSurfaceLayer(world_, settings.surfaceLayer);
  dWorldSetContactMaxCorrectingVel(world_, std::min(settings.maxCorrectingVelocity, double(dInfinity)));
  dWorldSetLinearDamping(world_, settings.linearDamping);
  dWorldSetAngularDamping(world_, settings.angularDamping);
  space_ = dHashSpaceCreate(nullptr);
  contactJoints_ = dJointGroupCreate(0);
  found_.resize(static_cast<std::size_t>(settings.maxContacts));
  data_.resize(found_.size());
}

World::~World() {
  clear();
}

void World::clear() {
  dJointGroupDestroy(contactJoints_);
  dSpaceDestroy(space_);  // with its geoms, before the heights that they read
  geoms_.clear();
  dWorldDestroy(world_);
}

const World::Body& World::body(int index) const {
  if (index < 0 || index >= static_cast<int>(bodies_.size())) throw ArgumentError("there is no body with this number");
  return bodies_[static_cast<std::size_t>(index)];
}

World::Body& World::body(int index) {
  return const_cast<Body&>(static_cast<const World*>(this)->body(index));
}

World::Joint& World::joint(int index) {
  if (index < 0 || index >= static_cast<int>(joints_.size())) throw ArgumentError("there is no joint with this number");
  return *joints_[static_cast<std::size_t>(index)];
}

std::vector<dGeomID> World::geomIds() const {
  std::vector<dGeomID> ids;
  for (const Geom& geom : geoms_) ids.push_back(geom.geom);
  return ids;
}

int World::makeGeom(const Part& part, const BodySettings& settings) {
  const auto& s = part.size;
  Geom geom;
  geom.pose = part.pose;
  switch (part.kind) {
    case ShapeKind::kMesh:
      geom.geom = dCreateGpuTriMesh(space_, part.mesh->data());
      if (geom.geom == nullptr) failWithLastError();
      geom.isMesh = true;
      geom.mesh = part.mesh;
      break;
    case ShapeKind::kBox:
      geom.geom = dCreateBox(space_, s[0], s[1], s[2]);
      break;
    case ShapeKind::kSphere:
      geom.geom = dCreateSphere(space_, s[0]);
      break;
    case ShapeKind::kCapsule:
      geom.geom = dCreateCapsule(space_, s[0], s[1]);
      break;
    case ShapeKind::kCylinder:
      geom.geom = dCreateCylinder(space_, s[0], s[1]);
      break;
    case ShapeKind::kPlane:
      geom.geom = dCreatePlane(space_, s[0], s[1], s[2], s[3]);
      break;
    case ShapeKind::kTerrain:
      geom.heights = std::make_unique<scenes::HeightfieldData>(*part.heights);
      geom.geom = geom.heights->makeGeom(space_, transformOf(product(settings.pose, part.pose)));
      break;
  }
  dGeomSetData(geom.geom, reinterpret_cast<void*>(geoms_.size()));
  geom.body = static_cast<int>(bodies_.size());
  const dGeomID id = geom.geom;
  const bool isMesh = geom.isMesh;
  geoms_.push_back(std::move(geom));
  if (isMesh) check(dGeomGpuTriMeshSetParams(id, &settings.params), "the options");
  return static_cast<int>(geoms_.size()) - 1;
}

void World::setMass(Body& body, const BodySettings& settings, const std::vector<Part>& parts) {
  dMass sum;
  dMassSetZero(&sum);
  for (const Part& part : parts) {
    dMass mass = massOf(part, settings.density > 0 ? settings.density : 1);
    const auto& m = part.pose;
    const dMatrix3 r{m[0], m[1], m[2], 0, m[4], m[5], m[6], 0, m[8], m[9], m[10], 0};
    dMassRotate(&mass, r);
    dMassTranslate(&mass, m[3], m[7], m[11]);
    dMassAdd(&sum, &mass);
  }
  if (settings.mass > 0) dMassAdjust(&sum, settings.mass);
  std::copy(sum.c, sum.c + 3, body.center.begin());
  dMassTranslate(&sum, -sum.c[0], -sum.c[1], -sum.c[2]);
  std::fill(sum.c, sum.c + 3, 0.0);  // rounding would leave a trace, which ODE refuses
  if (dMassCheck(&sum) == 0) throw ArgumentError("the shapes of a body make no mass that ODE can use");
  dBodySetMass(body.body, &sum);
  body.mass = sum.mass;
}

int World::addBody(const BodySettings& settings, const std::vector<Part>& parts) {
  const OneAtATime alone(busy_);
  prepareThread();
  checkPose(settings.pose.data());
  for (const Part& part : parts) checkPose(part.pose.data());
  Body body;
  body.kind = settings.kind;
  body.pose = settings.pose;
  body.friction = settings.friction;
  body.bounce = settings.bounce;
  const std::size_t geomsBefore = geoms_.size();
  try {
    if (settings.kind != BodyKind::kStatic) {
      body.body = dBodyCreate(world_);
      if (settings.kind == BodyKind::kDynamic)
        setMass(body, settings, parts);
      else
        dBodySetKinematic(body.body);
    }
    for (const Part& part : parts) {
      const int index = makeGeom(part, settings);
      body.geoms.push_back(index);
      const dGeomID geom = geoms_.back().geom;
      if (part.kind == ShapeKind::kPlane || part.kind == ShapeKind::kTerrain) {
        if (body.body != nullptr) throw ArgumentError("planes and terrains can only be static");
        continue;
      }
      if (body.body == nullptr) continue;
      // ODE wants the centre of mass at its body's origin: the geoms are offset instead.
      const auto& m = part.pose;
      const dMatrix3 r{m[0], m[1], m[2], 0, m[4], m[5], m[6], 0, m[8], m[9], m[10], 0};
      dGeomSetBody(geom, body.body);
      dGeomSetOffsetPosition(geom, m[3] - body.center[0], m[7] - body.center[1], m[11] - body.center[2]);
      dGeomSetOffsetRotation(geom, r);
    }
  } catch (...) {
    while (geoms_.size() > geomsBefore) {
      dGeomDestroy(geoms_.back().geom);
      geoms_.pop_back();
    }
    if (body.body != nullptr) dBodyDestroy(body.body);
    throw;
  }
  bodies_.push_back(std::move(body));
  const int index = static_cast<int>(bodies_.size()) - 1;
  setPose(index, settings.pose.data());
  return index;
}

void World::setPose(int index, const double* matrix) {
  checkPose(matrix);
  Body& target = body(index);
  std::copy(matrix, matrix + 16, target.pose.begin());
  if (target.body == nullptr) {
    for (const int number : target.geoms) {
      const Geom& geom = geoms_[static_cast<std::size_t>(number)];
      const int kind = dGeomGetClass(geom.geom);
      if (kind == dPlaneClass || geom.heights) continue;  // placed when they were made
      placeGeom(geom.geom, product(target.pose, geom.pose).data());
    }
    return;
  }
  const dMatrix3 r{matrix[0], matrix[1], matrix[2], 0,         matrix[4],  matrix[5],
                   matrix[6], 0,         matrix[8], matrix[9], matrix[10], 0};
  dBodySetRotation(target.body, r);
  dVector3 shift;
  dBodyVectorToWorld(target.body, target.center[0], target.center[1], target.center[2], shift);
  dBodySetPosition(target.body, matrix[3] + shift[0], matrix[7] + shift[1], matrix[11] + shift[2]);
}

std::array<double, 16> World::poseOf(const Body& body) const {
  if (body.body == nullptr) return body.pose;
  const dReal* p = dBodyGetPosition(body.body);
  dVector3 shift;
  dBodyVectorToWorld(body.body, body.center[0], body.center[1], body.center[2], shift);
  const dVector3 origin{p[0] - shift[0], p[1] - shift[1], p[2] - shift[2], 0};
  return matrixOf(dBodyGetRotation(body.body), origin);
}

int World::addJoint(const std::string& kind, int bodyA, int bodyB, const std::array<double, 3>& anchor,
                    const std::array<double, 3>& axis1, const std::array<double, 3>& axis2) {
  const OneAtATime alone(busy_);
  const dBodyID a = body(bodyA).body, b = bodyB < 0 ? nullptr : body(bodyB).body;
  if (a == b) throw ArgumentError("a joint needs two bodies of which at least one moves");
  auto joint = std::make_unique<Joint>();
  joint->kind = kind;
  joint->body1 = bodyA;
  joint->body2 = std::max(bodyB, -1);
  const dJointID id = joint->joint = kind == "ball"        ? dJointCreateBall(world_, nullptr)
                                     : kind == "hinge"     ? dJointCreateHinge(world_, nullptr)
                                     : kind == "slider"    ? dJointCreateSlider(world_, nullptr)
                                     : kind == "universal" ? dJointCreateUniversal(world_, nullptr)
                                     : kind == "fixed"     ? dJointCreateFixed(world_, nullptr)
                                                           : nullptr;
  if (id == nullptr) throw ArgumentError("'" + kind + "' is no kind of joint");
  dJointAttach(id, a, b);
  if (kind == "ball") {
    dJointSetBallAnchor(id, anchor[0], anchor[1], anchor[2]);
  } else if (kind == "hinge") {
    dJointSetHingeAnchor(id, anchor[0], anchor[1], anchor[2]);
    dJointSetHingeAxis(id, axis1[0], axis1[1], axis1[2]);
  } else if (kind == "slider") {
    dJointSetSliderAxis(id, axis1[0], axis1[1], axis1[2]);
  } else if (kind == "universal") {
    dJointSetUniversalAnchor(id, anchor[0], anchor[1], anchor[2]);
    dJointSetUniversalAxis1(id, axis1[0], axis1[1], axis1[2]);
    dJointSetUniversalAxis2(id, axis2[0], axis2[1], axis2[2]);
  } else {
    dJointSetFixed(id);
  }
  dJointSetFeedback(id, &joint->feedback);
  joints_.push_back(std::move(joint));
  return static_cast<int>(joints_.size()) - 1;
}

void World::checkPlaces() const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].body == nullptr) continue;
    const dReal *p = dBodyGetPosition(bodies_[i].body), *v = dBodyGetLinearVel(bodies_[i].body),
                *w = dBodyGetAngularVel(bodies_[i].body);
    double sum = 0, place = 0;
    for (int k = 0; k < 3; ++k) {
      sum += p[k] + v[k] + w[k];
      place = std::max(place, std::fabs(p[k]));
    }
    const std::string which = "body " + std::to_string(i);
    if (!std::isfinite(sum)) throw OdeError(which + " moves by numbers that are not finite");
    if (place > scenes::kFarthest) throw OdeError(which + " is more than 1e8 m from the origin");
  }
}

bool World::mayTouch(dGeomID a, dGeomID b) const {
  const Body &first = bodies_[static_cast<std::size_t>(geoms_[static_cast<std::size_t>(numberOf(a))].body)],
             &second = bodies_[static_cast<std::size_t>(geoms_[static_cast<std::size_t>(numberOf(b))].body)];
  if (&first == &second) return false;
  if (first.kind != BodyKind::kDynamic && second.kind != BodyKind::kDynamic) return false;
  if (first.body == nullptr || second.body == nullptr) return true;
  return dAreConnectedExcluding(first.body, second.body, dJointTypeContact) == 0;
}

int World::wanted(void* self, dGeomID a, dGeomID b) {
  return static_cast<World*>(self)->mayTouch(a, b) ? 1 : 0;
}

void World::nearCallback(void* self, dGeomID a, dGeomID b) {
  auto* world = static_cast<World*>(self);
  if (!world->mayTouch(a, b)) return;
  world->pairs_.push_back(numberOf(a) < numberOf(b) ? std::array{a, b} : std::array{b, a});
}

void World::collidePair(dGeomID a, dGeomID b) {
  const auto numberA = static_cast<std::size_t>(numberOf(a)), numberB = static_cast<std::size_t>(numberOf(b));
  const int limit = settings_.maxContacts;
  int count = 0;
  if (geoms_[numberA].isMesh && geoms_[numberB].isMesh) {
    count = check(dGpuTriMeshCollideEx(a, b, limit, found_.data(), sizeof(dContactGeom), data_.data(),
                                       sizeof(dGpuTriMeshContactData)));
  } else {
    count = dCollide(a, b, limit, found_.data(), sizeof(dContactGeom));
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      data_[i] = {};
      data_[i].triangle1 = found_[i].side1;
      data_[i].triangle2 = found_[i].side2;
      data_[i].vertex1 = data_[i].vertex2 = data_[i].region = -1;
      data_[i].coherence = -1;
    }
  }
  WorldContact contact;
  contact.geom1 = static_cast<int>(numberA);
  contact.geom2 = static_cast<int>(numberB);
  contact.body1 = geoms_[numberA].body;
  contact.body2 = geoms_[numberB].body;
  contact.friction = HUGE_VAL;
  contact.bounce = 0;
  for (const int index : {contact.body1, contact.body2}) {
    const Body& own = bodies_[static_cast<std::size_t>(index)];
    contact.friction = std::min(contact.friction, own.friction >= 0 ? own.friction : settings_.friction);
    contact.bounce = std::max(contact.bounce, own.bounce >= 0 ? own.bounce : settings_.bounce);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    contact.geom = found_[i];
    contact.data = data_[i];
    contacts_.push_back(contact);
  }
}

void World::collide() {
  prepareThread();
  checkPlaces();
  contacts_.clear();
  pairs_.clear();
  check(dGpuTriMeshPrefetchSpaces(&space_, 1, &wanted, this));
  dSpaceCollide(space_, this, &nearCallback);
  std::sort(pairs_.begin(), pairs_.end(), [](const auto& x, const auto& y) {
    return std::array{numberOf(x[0]), numberOf(x[1])} < std::array{numberOf(y[0]), numberOf(y[1])};
  });
  for (const auto& pair : pairs_) collidePair(pair[0], pair[1]);
}

void World::solve(double dt) {
  prepareThread();
  std::vector<dJointFeedback> feedback(contacts_.size());
  std::vector<dBodyID> firstBody(contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const WorldContact& found = contacts_[i];
    if (!found.used) continue;
    dContact contact = {};
    contact.geom = found.geom;
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = std::isinf(found.friction) ? dInfinity : found.friction;
    if (found.bounce > 0) {
      contact.surface.mode |= dContactBounce;
      contact.surface.bounce = found.bounce;
      contact.surface.bounce_vel = settings_.bounceVelocity;
    }
    const dJointID joint = dJointCreateContact(world_, contactJoints_, &contact);
    firstBody[i] = dGeomGetBody(found.geom.g1);
    dJointAttach(joint, firstBody[i], dGeomGetBody(found.geom.g2));
    dJointSetFeedback(joint, &feedback[i]);
  }
  if (settings_.quick) {
    const std::lock_guard lock(random_numbers);
    dRandSetSeed(randomState);
    dWorldQuickStep(world_, dt);
    randomState = dRandGetSeed();
  } else {
    dWorldStep(world_, dt);
  }
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    // A joint whose first body is the world has its bodies, and thereby the forces, exchanged.
    for (int k = 0; k < 3; ++k)
      contacts_[i].force[k] = firstBody[i] != nullptr ? feedback[i].f1[k] : -feedback[i].f1[k];
  }
  dJointGroupEmpty(contactJoints_);
  time += dt;
  ++steps;
}

std::array<double, 2> World::energy() const {
  std::array<double, 2> sum{};
  for (const Body& body : bodies_) {
    if (body.kind != BodyKind::kDynamic) continue;
    dMass mass;
    dBodyGetMass(body.body, &mass);
    const dReal *x = dBodyGetPosition(body.body), *v = dBodyGetLinearVel(body.body),
                *omega = dBodyGetAngularVel(body.body);
    dVector3 w;  // the inertia is in the body's frame
    dBodyVectorFromWorld(body.body, omega[0], omega[1], omega[2], w);
    for (std::size_t i = 0; i < 3; ++i) {
      const dReal* row = mass.I + 4 * i;
      sum[0] += 0.5 * mass.mass * v[i] * v[i] + 0.5 * w[i] * (row[0] * w[0] + row[1] * w[1] + row[2] * w[2]);
      sum[1] -= mass.mass * settings_.gravity[i] * x[i];
    }
  }
  return sum;
}

}  // namespace otg::python
