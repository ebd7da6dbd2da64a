// SPDX-License-Identifier: BSD-3-Clause
// The physics of Gazebo (its library for physics with the plugin for DART) without the rest of it, and without a line
// for this library. Steps a world of SDF whose collisions are meshes and says what became of its stack. Run it as it
// is, and with LD_PRELOAD=build/lib/libode_trimesh_gpu_preload.so before it.
//
// Arguments: the file of the plugin, the world, how many steps.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <ignition/common/MeshManager.hh>
#include <ignition/math/eigen3/Conversions.hh>
#include <ignition/physics/ConstructEmpty.hh>
#include <ignition/physics/ForwardStep.hh>
#include <ignition/physics/FrameSemantics.hh>
#include <ignition/physics/GetContacts.hh>
#include <ignition/physics/GetEntities.hh>
#include <ignition/physics/RequestEngine.hh>
#include <ignition/physics/mesh/MeshShape.hh>
#include <ignition/physics/sdf/ConstructLink.hh>
#include <ignition/physics/sdf/ConstructModel.hh>
#include <ignition/physics/sdf/ConstructWorld.hh>
#include <ignition/plugin/Loader.hh>
#include <regex>
#include <sdf/Collision.hh>
#include <sdf/Geometry.hh>
#include <sdf/Link.hh>
#include <sdf/Mesh.hh>
#include <sdf/Model.hh>
#include <sdf/Root.hh>
#include <sdf/World.hh>
#include <string>
#include <vector>

namespace {

namespace physics = ignition::physics;

struct Features : physics::FeatureList<physics::LinkFrameSemantics, physics::ForwardStep, physics::GetEntities,
                                       physics::GetContactsFromLastStepFeature, physics::sdf::ConstructSdfWorld,
                                       physics::mesh::AttachMeshShapeFeature> {};
using Link = physics::Link3dPtr<Features>;

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "%s\n", what);
  std::exit(1);
}

struct Box {
  Link link;
  Eigen::Vector3d start;
};

void attachMesh(const Link& link, const sdf::Collision& collision, const std::filesystem::path& folder) {
  const sdf::Mesh* const shape = collision.Geom()->MeshShape();
  if (shape == nullptr) fail("a collision is no mesh");
  const ignition::common::Mesh* const mesh = ignition::common::MeshManager::Instance()->Load(folder / shape->Uri());
  if (mesh == nullptr) fail("a mesh cannot be read");
  link->AttachMeshShape(collision.Name(), *mesh, Eigen::Isometry3d::Identity(),
                        ignition::math::eigen3::convert(shape->Scale()));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  const std::filesystem::path file = argv[2];
  const int steps = std::atoi(argv[3]);

  ignition::plugin::Loader loader;
  const auto names = loader.LoadLib(argv[1]);
  if (names.empty()) fail("the plugin cannot be loaded");
  const auto engine = physics::RequestEngine3d<Features>::From(loader.Instantiate(*names.begin()));
  if (engine == nullptr) fail("the plugin lacks a feature");

  sdf::Root root;
  if (!root.Load(file).empty() || root.WorldCount() != 1) fail("the world cannot be read");
  const sdf::World& described = *root.WorldByIndex(0);
  // The plugin makes no meshes from SDF. It gets the world without collisions, and then each mesh, as from Gazebo's
  // server.
  std::ifstream in(file);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  sdf::Root bare;
  if (!bare.LoadSdfString(std::regex_replace(text, std::regex("<collision[^]*?</collision>"), "")).empty()) {
    fail("the world without collisions cannot be read");
  }
  const auto world = engine->ConstructWorld(*bare.WorldByIndex(0));
  if (world == nullptr) fail("the world cannot be made");

  std::vector<Box> boxes;
  for (std::uint64_t i = 0; i < described.ModelCount(); ++i) {
    const sdf::Model& model = *described.ModelByIndex(i);
    const sdf::Link& body = *model.LinkByIndex(0);
    const Link link = world->GetModel(model.Name())->GetLink(body.Name());
    attachMesh(link, *body.CollisionByIndex(0), file.parent_path());
    if (!model.Static()) boxes.push_back({link, link->FrameDataRelativeToWorld().pose.translation()});
  }

  long contacts = 0;
  const auto started = std::chrono::steady_clock::now();
  physics::ForwardStep::Input input;
  physics::ForwardStep::State state;
  physics::ForwardStep::Output output;
  for (int step = 0; step < steps; ++step) {
    world->Step(output, state, input);
    contacts += static_cast<long>(world->GetContactsFromLastStep().size());
  }
  const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();

  double drift = 0, tilt = 0, height = 0;
  for (const Box& box : boxes) {
    const Eigen::Isometry3d pose = box.link->FrameDataRelativeToWorld().pose;
    const Eigen::Vector3d moved = pose.translation() - box.start;
    drift = std::max(drift, moved.head<2>().norm());
    tilt = std::max(tilt, std::acos(std::min(1.0, pose.linear()(2, 2))) * 57.29577951308232);
    height = std::max(height, std::abs(moved.z()));
  }
  std::printf(
      "{\"boxes\": %zu, \"steps\": %d, \"drift_m\": %.6g, \"tilt_deg\": %.6g, \"height_error_m\": %.6g, "
      "\"contacts_per_step\": %.4g, \"ms_per_step\": %.4g}\n",
      boxes.size(), steps, drift, tilt, height, static_cast<double>(contacts) / steps, 1e3 * spent / steps);
}
