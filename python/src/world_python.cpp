// SPDX-License-Identifier: BSD-3-Clause
// The class World as the Python side sees it.
#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstring>

#include "errors.h"
#include "module.h"
#include "world.h"
#include "world_state.h"

namespace otg::python {
namespace {

std::array<double, 16> toArray(const Pose& pose) {
  std::array<double, 16> values{};
  std::copy(pose.data(), pose.data() + 16, values.begin());
  return values;
}

Part makePart(ShapeKind kind, const std::array<double, 4>& size, const Pose& pose) {
  Part part;
  part.kind = kind;
  part.size = size;
  part.pose = toArray(pose);
  return part;
}

Part meshPart(const std::shared_ptr<Mesh>& mesh, const Pose& pose) {
  Part part = makePart(ShapeKind::kMesh, {}, pose);
  part.mesh = mesh;
  return part;
}

Part terrainPart(const InputArray<float, nb::shape<-1, -1>>& heights, double sizeX, double sizeY, double thickness,
                 const Pose& pose) {
  Part part = makePart(ShapeKind::kTerrain, {}, pose);
  auto grid = std::make_shared<scenes::HeightGrid>();
  grid->sizeX = sizeX;
  grid->sizeY = sizeY;
  grid->rows = static_cast<int>(heights.shape(0));
  grid->columns = static_cast<int>(heights.shape(1));
  grid->heights.assign(heights.data(), heights.data() + heights.size());
  grid->thickness = thickness;
  part.heights = std::move(grid);
  return part;
}

/// The world's frame from each body's.
OutputArray<double, nb::shape<-1, 4, 4>> poses(const World& world) {
  std::vector<double> values;
  for (const World::Body& body : world.bodies()) {
    const auto pose = world.poseOf(body);
    values.insert(values.end(), pose.begin(), pose.end());
  }
  const std::size_t count = world.bodies().size();
  return give<OutputArray<double, nb::shape<-1, 4, 4>>>(std::move(values), {count, 4, 4});
}

/// What `get` reads of each body that has one; zeros for static bodies.
Rows<double, 3> vectors(const World& world, const dReal* (*get)(dBodyID)) {
  std::vector<double> values;
  for (const World::Body& body : world.bodies()) {
    const dVector3 zero{};
    const dReal* v = body.body != nullptr ? get(body.body) : zero;
    values.insert(values.end(), v, v + 3);
  }
  return giveRows<3>(std::move(values));
}

Rows<double, 3> centers(const World& world) {
  std::vector<double> values;
  for (const World::Body& body : world.bodies()) {
    const dVector3 origin{body.pose[3], body.pose[7], body.pose[11], 0};
    const dReal* p = body.body != nullptr ? dBodyGetPosition(body.body) : origin;
    values.insert(values.end(), p, p + 3);
  }
  return giveRows<3>(std::move(values));
}

dBodyID moving(World& world, int index) {
  const dBodyID body = world.body(index).body;
  if (body == nullptr) throw ArgumentError("a static body has no velocity and takes no forces");
  return body;
}

using Triple = std::array<double, 3>;

void setVelocity(World& world, int index, const Triple& linear, const Triple& angular) {
  const OneAtATime alone(world.busy());
  const dBodyID body = moving(world, index);
  dBodySetLinearVel(body, linear[0], linear[1], linear[2]);
  dBodySetAngularVel(body, angular[0], angular[1], angular[2]);
}

void addForce(World& world, int index, const Triple& force, const Triple& torque) {
  const OneAtATime alone(world.busy());
  const dBodyID body = moving(world, index);
  dBodyAddForce(body, force[0], force[1], force[2]);
  dBodyAddTorque(body, torque[0], torque[1], torque[2]);
}

void addForceAt(World& world, int index, const Triple& force, const Triple& point) {
  const OneAtATime alone(world.busy());
  dBodyAddForceAtPos(moving(world, index), force[0], force[1], force[2], point[0], point[1], point[2]);
}

void step(World& world, double dt, int count) {
  const nb::gil_scoped_release unlocked;
  const OneAtATime alone(world.busy());
  for (int i = 0; i < count; ++i) {
    world.collide();
    world.solve(dt);
  }
}

void collideWorld(World& world) {
  const nb::gil_scoped_release unlocked;
  const OneAtATime alone(world.busy());
  world.collide();
}

void solveWorld(World& world, double dt, const InputArray<double, nb::shape<-1>>& friction,
                const InputArray<double, nb::shape<-1>>& bounce, const InputArray<bool, nb::shape<-1>>& used) {
  const nb::gil_scoped_release unlocked;
  const OneAtATime alone(world.busy());
  auto& contacts = world.contacts();
  if (friction.shape(0) != contacts.size() || bounce.shape(0) != contacts.size() || used.shape(0) != contacts.size()) {
    throw ArgumentError("there must be one value for each contact");
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (!(friction(i) >= 0) || !(bounce(i) >= 0)) throw ArgumentError("friction and bounce must not be negative");
    contacts[i].friction = friction(i);
    contacts[i].bounce = bounce(i);
    contacts[i].used = used(i);
  }
  world.solve(dt);
}

/// Contacts, and for each: bodies, geoms, friction, bounce, force.
std::tuple<ContactTuple, Rows<std::int32_t, 2>, Rows<std::int32_t, 2>, Column<double>, Column<double>, Rows<double, 3>>
contactsOf(World& world) {
  const OneAtATime alone(world.busy());
  ContactColumns columns;
  std::vector<std::int32_t> bodies, geoms;
  std::vector<double> friction, bounce, forces;
  for (const WorldContact& c : world.contacts()) {
    columns.add(c.geom, c.data);
    bodies.insert(bodies.end(), {c.body1, c.body2});
    geoms.insert(geoms.end(), {c.geom1, c.geom2});
    friction.push_back(c.friction);
    bounce.push_back(c.bounce);
    forces.insert(forces.end(), c.force, c.force + 3);
  }
  return {columns.give(),
          giveRows<2>(std::move(bodies)),
          giveRows<2>(std::move(geoms)),
          giveColumn(std::move(friction)),
          giveColumn(std::move(bounce)),
          giveRows<3>(std::move(forces))};
}

/// Position or angle, and its rate, of a hinge or slider.
std::array<double, 2> jointPosition(World& world, int index) {
  const World::Joint& joint = world.joint(index);
  if (joint.kind == "hinge") return {dJointGetHingeAngle(joint.joint), dJointGetHingeAngleRate(joint.joint)};
  if (joint.kind == "slider") return {dJointGetSliderPosition(joint.joint), dJointGetSliderPositionRate(joint.joint)};
  throw ArgumentError("a " + joint.kind + " joint has no single position");
}

void setJointParam(World& world, int index, int param, double value) {
  const OneAtATime alone(world.busy());
  const World::Joint& joint = world.joint(index);
  if (joint.kind == "hinge") {
    dJointSetHingeParam(joint.joint, param, value);
  } else if (joint.kind == "slider") {
    dJointSetSliderParam(joint.joint, param, value);
  } else {
    throw ArgumentError("a " + joint.kind + " joint has neither limits nor a motor");
  }
}

void setLimits(World& world, int index, double low, double high) {
  // Twice: ODE drops a limit that is on the wrong side of the other one.
  for (int i = 0; i < 2; ++i) {
    setJointParam(world, index, dParamLoStop, low);
    setJointParam(world, index, dParamHiStop, high);
  }
}

void setMotor(World& world, int index, double speed, double maxForce) {
  setJointParam(world, index, dParamVel, speed);
  setJointParam(world, index, dParamFMax, maxForce);
}

/// Force and torque of the last step on the first body, world.
std::array<double, 6> jointForce(World& world, int index) {
  const dJointFeedback& f = world.joint(index).feedback;
  return {f.f1[0], f.f1[1], f.f1[2], f.t1[0], f.t1[1], f.t1[2]};
}

}  // namespace

void bindWorld(nb::module_& module) {
  nb::enum_<ShapeKind>(module, "ShapeKind")
      .value("box", ShapeKind::kBox)
      .value("sphere", ShapeKind::kSphere)
      .value("capsule", ShapeKind::kCapsule)
      .value("cylinder", ShapeKind::kCylinder)
      .value("plane", ShapeKind::kPlane);
  nb::enum_<BodyKind>(module, "BodyKind")
      .value("dynamic", BodyKind::kDynamic)
      .value("static", BodyKind::kStatic)
      .value("kinematic", BodyKind::kKinematic);
  nb::class_<Part>(module, "Part", "A shape at a place of its body.")
      .def_static("shape", &makePart, nb::arg("kind"), nb::arg("size"), nb::arg("pose"))
      .def_static("mesh", &meshPart, nb::arg("mesh"), nb::arg("pose"))
      .def_static("terrain", &terrainPart, nb::arg("heights"), nb::arg("size_x"), nb::arg("size_y"),
                  nb::arg("thickness"), nb::arg("pose"));
  using Settings = WorldSettings;
  nb::class_<Settings>(module, "WorldSettings")
      .def(nb::init<>())
      .def_rw("gravity", &Settings::gravity)
      .def_rw("erp", &Settings::erp)
      .def_rw("cfm", &Settings::cfm)
      .def_rw("quick", &Settings::quick)
      .def_rw("iterations", &Settings::iterations)
      .def_rw("friction", &Settings::friction)
      .def_rw("bounce", &Settings::bounce)
      .def_rw("bounce_velocity", &Settings::bounceVelocity)
      .def_rw("surface_layer", &Settings::surfaceLayer)
      .def_rw("max_correcting_velocity", &Settings::maxCorrectingVelocity)
      .def_rw("linear_damping", &Settings::linearDamping)
      .def_rw("angular_damping", &Settings::angularDamping)
      .def_rw("max_contacts", &Settings::maxContacts)
      .def_rw("seed", &Settings::seed);
  nb::class_<World>(module, "World", "An ODE world. The package's `World` wraps it.")
      .def(nb::init<const Settings&>(), nb::arg("settings"))
      .def(
          "add_body",
          [](World& world, BodyKind kind, const Pose& pose, const std::vector<Part>& parts, double density, double mass,
             double friction, double bounce, const dGpuTriMeshParams& params) {
            BodySettings settings;
            settings.kind = kind;
            settings.pose = toArray(pose);
            settings.density = density;
            settings.mass = mass;
            settings.friction = friction;
            settings.bounce = bounce;
            settings.params = params;
            return world.addBody(settings, parts);
          },
          nb::arg("kind"), nb::arg("pose"), nb::arg("parts"), nb::arg("density"), nb::arg("mass"), nb::arg("friction"),
          nb::arg("bounce"), nb::arg("params"))
      .def("add_joint", &World::addJoint, nb::arg("kind"), nb::arg("body_a"), nb::arg("body_b"), nb::arg("anchor"),
           nb::arg("axis1"), nb::arg("axis2"))
      .def("remove_body", &World::removeBody, nb::arg("body"))
      .def("remove_joint", &World::removeJoint, nb::arg("joint"))
      .def("step", &step, nb::arg("dt"), nb::arg("count"))
      .def("collide", &collideWorld)
      .def("solve", &solveWorld, nb::arg("dt"), nb::arg("friction"), nb::arg("bounce"), nb::arg("used"))
      .def("contacts", &contactsOf)
      .def_ro("time", &World::time)
      .def_ro("steps", &World::steps)
      .def("poses", &poses)
      .def("centers", &centers)
      .def("linear_velocities", [](const World& world) { return vectors(world, &dBodyGetLinearVel); })
      .def("angular_velocities", [](const World& world) { return vectors(world, &dBodyGetAngularVel); })
      .def(
          "mass", [](World& world, int index) { return world.body(index).mass; }, nb::arg("body"))
      .def("energy", &World::energy)
      .def(
          "set_pose",
          [](World& world, int index, const Pose& pose) {
            const OneAtATime alone(world.busy());
            world.setPose(index, pose.data());
          },
          nb::arg("body"), nb::arg("pose"))
      .def("set_velocity", &setVelocity, nb::arg("body"), nb::arg("linear"), nb::arg("angular"))
      .def("add_force", &addForce, nb::arg("body"), nb::arg("force"), nb::arg("torque"))
      .def("add_force_at", &addForceAt, nb::arg("body"), nb::arg("force"), nb::arg("point"))
      .def("joint_position", &jointPosition, nb::arg("joint"))
      .def("set_limits", &setLimits, nb::arg("joint"), nb::arg("low"), nb::arg("high"))
      .def("set_motor", &setMotor, nb::arg("joint"), nb::arg("speed"), nb::arg("max_force"))
      .def("joint_force", &jointForce, nb::arg("joint"))
      .def("save", &saveState, "The state of the world as bytes.")
      .def("load", &loadState, nb::arg("data"));
}

}  // namespace otg::python
