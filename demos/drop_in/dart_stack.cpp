// SPDX-License-Identifier: BSD-3-Clause
// A program on DART that knows nothing of this library: DART's ODE collision detector makes a dTriMesh of every mesh.
// It stacks boxes that come from a mesh file and says what became of the stack. Run it as it is, and with
// LD_PRELOAD=build/lib/libode_trimesh_gpu_preload.so before it.
//
// Arguments: how many boxes, how many steps of 1 ms.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <dart/collision/ode/ode.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/MeshShape.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>
#include <fstream>
#include <string>

namespace {

/// A box as a mesh file: 12 triangles, outward.
std::string writeBox(const std::string& path, double x, double y, double z) {
  std::ofstream out(path);
  for (int i = 0; i < 8; ++i) {
    out << "v " << (i & 1 ? x : -x) / 2 << ' ' << (i & 2 ? y : -y) / 2 << ' ' << (i & 4 ? z : -z) / 2 << '\n';
  }
  out << "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n";
  return path;
}

std::shared_ptr<dart::dynamics::MeshShape> meshShape(const std::string& path) {
  const aiScene* const scene = dart::dynamics::MeshShape::loadMesh(path);
  if (scene == nullptr) std::exit(1);
  return std::make_shared<dart::dynamics::MeshShape>(Eigen::Vector3d::Ones(), scene, path);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace dart;
  const int count = argc > 1 ? std::atoi(argv[1]) : 5, steps = argc > 2 ? std::atoi(argv[2]) : 2000;
  if (count < 1 || steps < 1) return 2;
  char folder[] = "/tmp/dart_stack_XXXXXX";
  if (mkdtemp(folder) == nullptr) return 1;
  const std::string box = writeBox(std::string(folder) + "/box.obj", 0.5, 0.5, 0.5);
  const std::string slab = writeBox(std::string(folder) + "/slab.obj", 6, 6, 1);

  const auto world = simulation::World::create();
  world->setTimeStep(0.001);
  world->getConstraintSolver()->setCollisionDetector(collision::OdeCollisionDetector::create());

  const auto ground = dynamics::Skeleton::create("ground");
  const auto groundNode = ground->createJointAndBodyNodePair<dynamics::WeldJoint>().second;
  groundNode->createShapeNodeWith<dynamics::CollisionAspect, dynamics::DynamicsAspect>(meshShape(slab));
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.translation().z() = -0.5;
  groundNode->getParentJoint()->setTransformFromParentBodyNode(place);
  world->addSkeleton(ground);

  std::vector<dynamics::BodyNode*> nodes;
  const auto shape = meshShape(box);
  for (int i = 0; i < count; ++i) {
    const auto body = dynamics::Skeleton::create("box" + std::to_string(i));
    const auto [joint, node] = body->createJointAndBodyNodePair<dynamics::FreeJoint>();
    node->createShapeNodeWith<dynamics::CollisionAspect, dynamics::DynamicsAspect>(shape);
    dynamics::Inertia inertia;
    inertia.setMass(10);
    const double moment = 10 * 0.25 / 6;  // of a cube
    inertia.setMoment(moment, moment, moment, 0, 0, 0);
    node->setInertia(inertia);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().z() = 0.25 + 0.5 * i;
    joint->setTransform(pose);
    world->addSkeleton(body);
    nodes.push_back(node);
  }

  long contacts = 0;
  const auto started = std::chrono::steady_clock::now();
  for (int step = 0; step < steps; ++step) {
    world->step();
    contacts += static_cast<long>(world->getLastCollisionResult().getNumContacts());
  }
  const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();

  double drift = 0, tilt = 0, height = 0;
  for (int i = 0; i < count; ++i) {
    const Eigen::Isometry3d pose = nodes[static_cast<std::size_t>(i)]->getWorldTransform();
    drift = std::max(drift, pose.translation().head<2>().norm());
    tilt = std::max(tilt, std::acos(std::min(1.0, pose.linear()(2, 2))) * 57.29577951308232);
    height = std::max(height, std::abs(pose.translation().z() - 0.25 - 0.5 * i));
  }
  std::printf(
      "{\"boxes\": %d, \"steps\": %d, \"drift_m\": %.6g, \"tilt_deg\": %.6g, \"height_error_m\": %.6g, "
      "\"contacts_per_step\": %.4g, \"ms_per_step\": %.4g}\n",
      count, steps, drift, tilt, height, static_cast<double>(contacts) / steps, 1e3 * spent / steps);
  std::remove(box.c_str());
  std::remove(slab.c_str());
  return std::remove(folder) == 0 ? 0 : 1;
}
