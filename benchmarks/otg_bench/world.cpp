// SPDX-License-Identifier: BSD-3-Clause
// `otg bench world`: whole steps of scenes, of ODE's own shapes, its dTriMesh and our meshes.
#include <fmt/format.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <chrono>
#include <cstdarg>
#include <memory>
#include <span>

#include "cli/progress.h"
#include "otg_bench/bench.h"
#include "otg_bench/geoms.h"
#include "otg_bench/world_scenes.h"
#include "scenes/simulation.h"

namespace otg::cli {
namespace {

struct WorldOptions {
  bool json = false;
  int steps = 200, settle = -1;
  std::string scene;
};

/// kArray: as kOurs, with dGpuTriMeshCollideSpace() in place of a near callback.
enum class WorldForm { kNative, kStock, kOurs, kArray };

const char* nameOfForm(WorldForm form) {
  switch (form) {
    case WorldForm::kNative:
      return "native";
    case WorldForm::kStock:
      return "stock";
    case WorldForm::kOurs:
      return "ours";
    case WorldForm::kArray:
      return "ours, array";
  }
  return "";
}

using WorldClock = std::chrono::steady_clock;

double worldMicroseconds(WorldClock::time_point from, WorldClock::time_point to) {
  return std::chrono::duration<double, std::micro>(to - from).count();
}

/// A scene as a world of ODE's.
class BenchWorld {
 public:
  BenchWorld(const WorldScene& scene, WorldForm form) : form_(form), dt_(scene.dt) {
    dWorldSetGravity(world_, 0, 0, -9.81);
    dWorldSetQuickStepNumIterations(world_, 20);
    dWorldSetDamping(world_, 0.005, 0.01);  // nothing rolls for ever
    dWorldSetAutoDisableFlag(world_, scene.sleeps);
    if (scene.ground.triangles.empty()) {
      dCreatePlane(space_, 0, 0, 1, 0);
    } else {
      makeMesh(scene.ground);
      dSpaceAdd(space_, meshGeom());
    }
    std::vector<std::size_t> place(scene.shapes.size(), 0);
    std::vector<dMass> masses(scene.shapes.size());
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
      masses[i] = massOf(scene.shapes[i].mesh);
      if (form == WorldForm::kNative) continue;
      makeMesh(scene.shapes[i].mesh);
      place[i] = stock_.size() + ours_.size() - 1;
    }
    for (const WorldBody& from : scene.bodies) {
      const dBodyID body = dBodyCreate(world_);
      dBodySetMass(body, &masses[from.shape]);
      const dGeomID geom =
          form == WorldForm::kNative ? scene.shapes[from.shape].native(nullptr) : meshGeom(place[from.shape]);
      dSpaceAdd(space_, geom);
      dGeomSetBody(geom, body);
      poseGeom(geom, from.pose);
      bodies_.push_back(body);
    }
  }
  ~BenchWorld() {
    dJointGroupDestroy(joints_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
    for (const dTriMeshDataID data : stock_) dGeomTriMeshDataDestroy(data);
    for (const dGpuTriMeshDataID data : ours_) dGpuTriMeshDataDestroy(data);
  }
  BenchWorld(const BenchWorld&) = delete;
  BenchWorld& operator=(const BenchWorld&) = delete;

  /// `isTimed`: whether the times count. Those of dCollide come from every other step, so that reading the clock does
  /// not add to the collision as a whole.
  void step(bool isTimed) {
    dRandSetSeed(random_);  // ODE's generator is the process's
    contacts_.clear();
    insideUs_ = 0;
    pairs_ = 0;
    asksClock_ = isTimed && steps_ % 2 == 1;
    const WorldClock::time_point begin = WorldClock::now();
    if (form_ == WorldForm::kArray) {
      collideAsArray();
    } else {
      dSpaceCollide(space_, this, &nearCallback);
      found_ = contacts_;
    }
    const WorldClock::time_point collided = WorldClock::now();
    for (const dContact& contact : found_) {
      const dJointID joint = dJointCreateContact(world_, joints_, &contact);
      dJointAttach(joint, dGeomGetBody(contact.geom.g1), dGeomGetBody(contact.geom.g2));
    }
    const WorldClock::time_point joined = WorldClock::now();
    dWorldQuickStep(world_, dt_);
    const WorldClock::time_point solved = WorldClock::now();
    dJointGroupEmpty(joints_);
    random_ = dRandGetSeed();
    if (!isTimed) return;
    ++steps_;
    contactCounts_.push_back(static_cast<double>(found_.size()));
    pairCounts_.push_back(static_cast<double>(pairs_));
    jointUs_.push_back(worldMicroseconds(collided, joined));
    solverUs_.push_back(worldMicroseconds(joined, solved));
    if (asksClock_) {
      collideUs_.push_back(insideUs_);
    } else {
      collisionUs_.push_back(worldMicroseconds(begin, collided));
    }
  }

  Json row(const std::string& scene) const {
    return {{"scene", scene},
            {"form", nameOfForm(form_)},
            {"pairs", median(pairCounts_)},
            {"contacts", median(contactCounts_)},
            {"collision_us", median(collisionUs_)},
            {"dcollide_us", median(collideUs_)},
            {"joints_us", median(jointUs_)},
            {"solver_us", median(solverUs_)},
            {"fastest_m_s", fastest()},
            {"hash", hash()}};
  }

 private:
  static constexpr int kPlaces = 64;

  void makeMesh(const scenes::MeshArrays& mesh) {
    if (form_ == WorldForm::kStock) {
      kept_.push_back(std::make_unique<scenes::MeshArrays>(mesh));
      const MeshInput in = kept_.back()->input();
      stock_.push_back(dGeomTriMeshDataCreate());
      dGeomTriMeshDataBuildSingle(stock_.back(), in.vertices, sizeof(Vec3f), static_cast<int>(in.vertexCount),
                                  in.indices, static_cast<int>(3 * in.triangleCount), sizeof(Triangle));
      dGeomTriMeshDataPreprocess2(stock_.back(), (1U << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES), nullptr);
    } else {
      ours_.push_back(meshData(*scenes::build(mesh), "a mesh of this benchmark"));
    }
  }
  dGeomID meshGeom(std::size_t i = 0) const {
    return form_ == WorldForm::kStock ? dCreateTriMesh(nullptr, stock_[i], nullptr, nullptr, nullptr)
                                      : dCreateGpuTriMesh(nullptr, ours_[i]);
  }
  static dMass massOf(const scenes::MeshArrays& mesh) {
    const MassProperties properties = scenes::build(mesh)->massProperties();
    const auto& i = properties.inertia;
    dMass mass;
    dMassSetParameters(&mass, properties.volume, 0, 0, 0, i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2));
    return mass;
  }

  static void nearCallback(void* self, dGeomID a, dGeomID b) { static_cast<BenchWorld*>(self)->collide(a, b); }
  void collide(dGeomID a, dGeomID b) {
    ++pairs_;
    const WorldClock::time_point begin = asksClock_ ? WorldClock::now() : WorldClock::time_point{};
    const int count = dCollide(a, b, kPlaces, ofPair_, sizeof(dContactGeom));
    if (asksClock_) insideUs_ += worldMicroseconds(begin, WorldClock::now());
    for (int i = 0; i < count; ++i) {
      dContact& contact = contacts_.emplace_back();
      contact.geom = ofPair_[i];
      setSurface(contact);
    }
  }
  static void setSurface(dContact& contact) {
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = 0.8;
  }

  void collideAsArray() {
    const WorldClock::time_point begin = WorldClock::now();
    const auto countPair = [](void* self, dGeomID, dGeomID) { return ++static_cast<BenchWorld*>(self)->pairs_; };
    const int count = dGpuTriMeshCollideSpace(space_, kPlaces, countPair, this, &places_[0].geom, sizeof(dContact),
                                              static_cast<int>(places_.size()));
    found_ = std::span(places_).first(static_cast<std::size_t>(std::max(count, 0)));
    for (dContact& contact : found_) setSurface(contact);
    insideUs_ = worldMicroseconds(begin, WorldClock::now());
  }

  double fastest() const {
    dReal most = 0;
    for (const dBodyID body : bodies_) most = std::max(most, dCalcVectorLength3(dBodyGetLinearVel(body)));
    return static_cast<double>(most);
  }
  std::string hash() const {
    Fnv1a hash;
    for (const dBodyID body : bodies_) {
      for (int k = 0; k < 3; ++k) hash.add(dBodyGetPosition(body)[k]);
      for (int k = 0; k < 4; ++k) hash.add(dBodyGetQuaternion(body)[k]);
    }
    return hash.hex();
  }

  const WorldForm form_;
  const double dt_;
  const dWorldID world_ = dWorldCreate();
  const dSpaceID space_ = dHashSpaceCreate(nullptr);
  const dJointGroupID joints_ = dJointGroupCreate(0);
  std::vector<std::unique_ptr<scenes::MeshArrays>> kept_;  ///< a dTriMesh reads its arrays where they are
  std::vector<dTriMeshDataID> stock_;
  std::vector<dGpuTriMeshDataID> ours_;
  std::vector<dBodyID> bodies_;
  std::vector<dContact> contacts_;  ///< of one step's near callbacks
  std::vector<dContact> places_ = std::vector<dContact>(form_ == WorldForm::kArray ? std::size_t{1} << 14 : 1);
  std::span<dContact> found_;  ///< the contacts of one step
  dContactGeom ofPair_[kPlaces];
  unsigned long random_ = 1;
  bool asksClock_ = false;
  double insideUs_ = 0;
  int pairs_ = 0, steps_ = 0;
  std::vector<double> collisionUs_, collideUs_, jointUs_, solverUs_, contactCounts_, pairCounts_;
};

/// The forms take turns, so that a busy machine is as busy for all of them.
Json runScene(const WorldScene& scene, const WorldOptions& options) {
  std::vector<std::unique_ptr<BenchWorld>> worlds;
  for (const WorldForm form : {WorldForm::kNative, WorldForm::kStock, WorldForm::kOurs, WorldForm::kArray}) {
    if (form == WorldForm::kNative && !scene.hasNative()) continue;
    worlds.push_back(std::make_unique<BenchWorld>(scene, form));
  }
  constexpr int kTurn = 20;  // steps: enough for warm caches
  const int settle = options.settle >= 0 ? options.settle : scene.settle, all = settle + options.steps;
  Progress turns(static_cast<std::size_t>((all + kTurn - 1) / kTurn));
  for (int from = 0; from < all; from += kTurn, turns.step()) {
    for (const auto& world : worlds) {
      for (int step = from; step < std::min(from + kTurn, all); ++step) world->step(step >= settle);
    }
  }
  Json rows = Json::array();
  for (const auto& world : worlds) rows.push_back(world->row(scene.name));
  return rows;
}

int benchWorld(const WorldOptions& options) {
  const scenes::OdeSession session;
  dSetMessageHandler([](int, const char*, va_list) {});  // what a dTriMesh says of buckets that are full
  Json rows = Json::array();
  std::vector<WorldScene> scenes = worldScenes();
  std::erase_if(scenes, [&](const WorldScene& s) { return s.name.find(options.scene) == std::string::npos; });
  Progress all(scenes.size());
  for (const WorldScene& scene : scenes) {
    for (const Json& row : runScene(scene, options)) rows.push_back(row);
    all.step();
  }
  dSetMessageHandler(nullptr);
  if (options.json) {
    printJson({{"bench", "world"}, {"tables", {{"worlds", rows}}}});
  } else {
    printTable("Whole steps of worlds: medians of microseconds a step", rows);
  }
  return 0;
}

}  // namespace

void addBenchWorld(CLI::App& bench, Action& action) {
  CLI::App* command =
      bench.add_subcommand("world", "Whole steps of scenes: ODE's shapes, its dTriMesh, and our meshes");
  auto options = std::make_shared<WorldOptions>();
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->add_option("--steps", options->steps, "Steps that are measured")->check(CLI::Range(1, 1000000));
  command->add_option("--settle", options->settle, "Steps before these; each scene has its own number by default")
      ->check(CLI::Range(0, 1000000));
  command->add_option("--scene", options->scene, "Only scenes whose name contains this");
  command->callback([options, &action] { action = [options] { return benchWorld(*options); }; });
}

}  // namespace otg::cli
