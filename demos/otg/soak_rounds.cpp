// SPDX-License-Identifier: BSD-3-Clause
#include "otg/soak_rounds.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "ode_trimesh_gpu/ode_trimesh_gpu.h"
#include "opencl/runtime/call.h"
#include "scenes/concave_meshes.h"
#include "scenes/generated_meshes.h"
#include "scenes/simulation.h"

namespace otg::cli {
namespace {

using scenes::MeshArrays;

using Bytes = std::vector<unsigned char>;

template <class T>
void append(Bytes& bytes, const T& value) {
  const auto* first = reinterpret_cast<const unsigned char*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof value);
}

/// What programs read of a contact. Its geoms are pointers, and the rest may be padding.
void appendContact(Bytes& bytes, const dContactGeom& c) {
  for (int k = 0; k < 3; ++k) {
    append(bytes, c.pos[k]);
    append(bytes, c.normal[k]);
  }
  append(bytes, c.depth);
  append(bytes, c.side1);
  append(bytes, c.side2);
}

MeshArrays openSheet(double size, int cells, double height) {
  MeshArrays mesh;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      const double x = size * (double(i) / cells - 0.5), y = size * (double(j) / cells - 0.5);
      mesh.vertices.push_back(scenes::toFloat({x, y, height * std::sin(3 * x) * std::cos(2 * y)}));
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (cells + 1) + j); };
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      mesh.triangles.push_back({{at(i, j), at(i + 1, j), at(i + 1, j + 1)}});
      mesh.triangles.push_back({{at(i, j), at(i + 1, j + 1), at(i, j + 1)}});
    }
  }
  return mesh;
}

constexpr int kBodyKinds = 8;

MeshArrays bodyMesh(int kind, unsigned seed) {
  switch (kind) {
    case 0:
      return scenes::makeBox({0.6, 0.5, 0.4}, 1);
    case 1:
      return scenes::makeBox({0.5, 0.5, 0.5}, 4);
    case 2:
      return scenes::makeSphere(0.35, 2);
    case 3:
      return scenes::makeLump(0.4, 3, 0.3, seed);
    case 4:
      return scenes::makeTorus(0.35, 0.12, 18, 10);
    case 5:
      return scenes::makeCorner(0.7, 0.15, 0.5);
    case 6:
      return scenes::makeGear(12, 0.4, 0.1, 0.2, 0.1);
    default:
      return openSheet(0.8, 2, 0.05);  // a shell
  }
}

MeshArrays groundMesh(int kind) {
  const auto hills = [](double x, double y) { return 0.1 * std::sin(2 * x) * std::cos(3 * y); };
  if (kind == 0) return scenes::makeGround(8, 1, 1);
  return kind == 1 ? scenes::makeGround(8, 1, 16, hills) : openSheet(8, 16, 0.05);
}

class MeshData {
 public:
  explicit MeshData(const MeshArrays& mesh) : id(dGpuTriMeshDataCreate()) {
    dGpuTriMeshDataBuildSingle(id, mesh.vertices.data(), sizeof(Vec3f), static_cast<int>(mesh.vertices.size()),
                               mesh.triangles.data(), static_cast<int>(3 * mesh.triangles.size()), sizeof(Triangle));
  }
  ~MeshData() { dGpuTriMeshDataDestroy(id); }
  MeshData(const MeshData&) = delete;
  MeshData& operator=(const MeshData&) = delete;
  const dGpuTriMeshDataID id;
};

/// Geoms in random poses near each other.
class Geoms {
 public:
  Geoms(int count, std::mt19937& random) {
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    for (int k = 0; k < kBodyKinds; ++k) data_.push_back(std::make_unique<MeshData>(bodyMesh(k, random())));
    for (int i = 0; i < count; ++i) {
      const dGeomID geom = dCreateGpuTriMesh(nullptr, data_[random() % data_.size()]->id);
      dGeomSetPosition(geom, uniform(-0.6, 0.6), uniform(-0.6, 0.6), uniform(-0.6, 0.6));
      dQuaternion turn{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(0.1, 1)};
      dNormalize4(turn);
      dGeomSetQuaternion(geom, turn);
      dReal box[6];
      dGeomGetAABB(geom, box);  // worked out on demand, in one thread
      ids.push_back(geom);
    }
  }
  ~Geoms() {
    for (const dGeomID geom : ids) dGeomDestroy(geom);
  }
  Geoms(const Geoms&) = delete;
  Geoms& operator=(const Geoms&) = delete;

  dGpuTriMeshDataID data(std::size_t k) const { return data_[k]->id; }
  std::vector<dGeomID> ids;

 private:
  std::vector<std::unique_ptr<MeshData>> data_;
};

Bytes statesOf(const scenes::Simulation& simulation) {
  Bytes bytes;
  for (std::size_t i = 0; i < simulation.bodyCount(); ++i) append(bytes, simulation.state(i));
  return bytes;
}

/// Saves what the pairs of a world remember, forgets it, and puts it back.
bool saveAndLoad(const scenes::Simulation& simulation) {
  std::vector<dGeomID> geoms;
  for (std::size_t i = 0; i < simulation.bodyCount(); ++i) geoms.push_back(simulation.geom(i));
  const int count = static_cast<int>(geoms.size());
  Bytes saved(dGpuTriMeshHistorySave(geoms.data(), count, nullptr, 0));
  if (dGpuTriMeshHistorySave(geoms.data(), count, saved.data(), saved.size()) != saved.size()) return false;
  for (const dGeomID geom : geoms) dGeomGpuTriMeshForgetHistory(geom);
  return dGpuTriMeshHistoryLoad(geoms.data(), count, saved.data(), saved.size()) == dGPUTRIMESH_OK;
}

}  // namespace

SoakRounds::~SoakRounds() {
  opencl::FaultInjection::failAt(0);
}

double SoakRounds::uniform(double low, double high) {
  return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
}

void SoakRounds::compare(bool same, const char* what) {
  ++counts_.compared;
  if (same) return;
  if (counts_.differences++ == 0) counts_.firstDifference = std::string(what) + ", round " + std::to_string(seed_);
}

void SoakRounds::settle() {
  opencl::FaultInjection::failAt(0);
  dGpuTriMeshCloseDevices();
  isOpen_ = false;
  dGpuTriMeshSetThreadCount(1);
}

void SoakRounds::chooseDevices() {
  opencl::FaultInjection::failAt(0);
  dGpuTriMeshSetThreadCount(1 + below(3));
  if (!withDevice_) return;
  if (isOpen_ && below(4) == 0) {
    dGpuTriMeshCloseDevices();
    isOpen_ = false;
  }
  if (!isOpen_ && below(2) == 0) {
    isOpen_ = dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK;
    counts_.devicesOpened += isOpen_ ? 1 : 0;
  }
  if (isOpen_ && below(4) == 0) {
    opencl::FaultInjection::failAt(1 + static_cast<std::uint64_t>(below(300)));
    ++counts_.callsFailed;
  }
}

void SoakRounds::run(std::uint64_t seed) {
  seed_ = seed;
  random_.seed(static_cast<std::mt19937::result_type>(seed));
  chooseDevices();
  const int kind = below(4);
  if (kind == 0) {
    world();
  } else if (kind == 1) {
    questions();
  } else {
    pairs();
  }
  ++counts_.rounds;
}

/// A world on the CPU, step by step, and the same world with a prefetch, devices, and its memory saved and put back.
void SoakRounds::world() {
  scenes::SceneDescription scene;
  scene.stepper = below(2) == 0 ? scenes::Stepper::kWorld : scenes::Stepper::kQuick;
  scene.space = static_cast<scenes::SpaceKind>(below(3));
  scene.seed = random_();
  scene.maxContacts = 16;
  scene.cfm = 1e-5;
  scene.maxCorrectingVelocity = 2;
  scenes::BodyDescription ground;
  ground.name = "ground";
  ground.isStatic = true;
  ground.mesh = scenes::build(groundMesh(below(3)));
  scene.bodies.push_back(ground);
  const int bodies = 3 + below(8);
  for (int i = 0; i < bodies; ++i) {
    scenes::BodyDescription body;
    body.name = "body";
    body.mass = uniform(0.5, 2);
    body.position = {uniform(-0.7, 0.7), uniform(-0.7, 0.7), 0.5 + 0.45 * i};
    const double angle = uniform(0, 3);
    body.rotation[0] = std::cos(angle / 2);
    body.rotation[1 + below(3)] = std::sin(angle / 2);
    if (below(4) == 0) {
      body.collider = scenes::Collider::kPrimitive;
      body.shape = std::array{scenes::ShapeKind::kBox, scenes::ShapeKind::kSphere, scenes::ShapeKind::kCylinder,
                              scenes::ShapeKind::kCapsule}[static_cast<std::size_t>(below(4))];
      body.size = body.shape == scenes::ShapeKind::kBox ? Vec3d{0.5, 0.4, 0.6} : Vec3d{0.25, 0.4, 0};
    } else {
      body.mesh = scenes::build(bodyMesh(below(kBodyKinds), random_()));
    }
    scene.bodies.push_back(body);
  }
  const int steps = 40 + below(120);
  const bool prefetches = below(2) == 0;
  Bytes states[2];
  for (int way = 0; way < 2; ++way) {
    scenes::Simulation simulation(scene);
    if (way == 0) {
      for (std::size_t i = 0; i < simulation.bodyCount(); ++i) {
        if (scene.bodies[i].collider == scenes::Collider::kGpuTriMesh) {
          dGeomGpuTriMeshSetBackend(simulation.geom(i), dGPUTRIMESH_BACKEND_CPU);
        }
      }
    }
    simulation.setPrefetch(way == 1 && prefetches);
    for (int i = 0; i < steps; ++i) {
      simulation.step(scene.dt);
      if (way == 1 && i == steps / 2) compare(saveAndLoad(simulation), "memory of pairs saved and put back");
    }
    states[way] = statesOf(simulation);
    for (std::size_t i = 0; i < simulation.bodyCount(); ++i) {
      dGpuTriMeshStats stats;
      dGpuTriMeshStatsInit(&stats);
      if (dGeomGpuTriMeshGetStats(simulation.geom(i), &stats) == dGPUTRIMESH_OK) counts_.queries += stats.queries;
    }
    ++counts_.worlds;
    counts_.steps += static_cast<std::uint64_t>(steps);
  }
  compare(states[0] == states[1], "world");
}

/// Pairs one by one on the CPU, as an array, and as a batch in the background, also when vertices have moved.
void SoakRounds::pairs() {
  constexpr int kPlaces = 16;
  const Geoms geoms(16 + below(48), random_);
  std::vector<dGpuTriMeshPair> pairs(static_cast<std::size_t>(100 + below(400)));
  for (dGpuTriMeshPair& pair : pairs) {
    const std::size_t a = random_() % geoms.ids.size(), b = random_() % geoms.ids.size();
    pair = {geoms.ids[a], geoms.ids[b == a ? (a + 1) % geoms.ids.size() : b]};
  }
  const int count = static_cast<int>(pairs.size());
  if (below(2) == 0) {
    const MeshArrays moved = bodyMesh(3, random_());
    compare(dGpuTriMeshDataUpdateVerticesSingle(geoms.data(3), moved.vertices.data(), sizeof(Vec3f),
                                                static_cast<int>(moved.vertices.size())) == dGPUTRIMESH_OK,
            "moved vertices");
    for (const dGeomID geom : geoms.ids) {
      dReal box[6];
      dGeomGetAABB(geom, box);
    }
  }
  std::vector<dContactGeom> contacts(pairs.size() * kPlaces);
  const int size = static_cast<int>(sizeof(dContactGeom));
  const auto setBackend = [&](int backend) {
    for (const dGeomID geom : geoms.ids) {
      dGeomGpuTriMeshSetBackend(geom, backend);
      dGeomGpuTriMeshForgetHistory(geom);
    }
  };
  Bytes single, array, background;
  setBackend(dGPUTRIMESH_BACKEND_CPU);
  for (const dGpuTriMeshPair& pair : pairs) {
    const int found = dCollide(pair.o1, pair.o2, kPlaces, contacts.data(), size);
    append(single, found);
    for (int k = 0; k < found; ++k) appendContact(single, contacts[static_cast<std::size_t>(k)]);
  }
  setBackend(dGPUTRIMESH_BACKEND_AUTO);
  std::vector<int> found(pairs.size());
  dGpuTriMeshCollidePairs(pairs.data(), count, kPlaces, contacts.data(), size, found.data());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    append(array, found[i]);
    for (std::size_t k = 0; k < static_cast<std::size_t>(found[i]); ++k) {
      appendContact(array, contacts[i * kPlaces + k]);
    }
  }
  compare(single == array, "array of pairs");
  setBackend(dGPUTRIMESH_BACKEND_AUTO);
  std::vector<int> first(pairs.size() + 1);
  const dGpuTriMeshBatchID batch = dGpuTriMeshBatchSubmit(pairs.data(), count, kPlaces);
  const int all = dGpuTriMeshBatchWait(batch);
  if (all >= 0 && dGpuTriMeshBatchCollect(batch, contacts.data(), size, nullptr, 0, first.data()) >= 0) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      append(background, first[i + 1] - first[i]);
      for (int k = first[i]; k < first[i + 1]; ++k) appendContact(background, contacts[static_cast<std::size_t>(k)]);
    }
  }
  dGpuTriMeshBatchDestroy(batch);
  compare(single == background, "pairs in the background");
  counts_.queries += 3 * pairs.size();
}

/// Overlaps, distances, points and rays, one by one on the CPU and as arrays.
void SoakRounds::questions() {
  const Geoms geoms(8 + below(16), random_);
  std::vector<dGpuTriMeshPair> pairs(static_cast<std::size_t>(50 + below(150)));
  for (dGpuTriMeshPair& pair : pairs) {
    const std::size_t a = random_() % geoms.ids.size();
    pair = {geoms.ids[a], geoms.ids[(a + 1 + random_() % (geoms.ids.size() - 1)) % geoms.ids.size()]};
  }
  const int count = static_cast<int>(pairs.size());
  std::vector<unsigned char> overlaps(pairs.size());
  std::vector<dGpuTriMeshDistance> distances(pairs.size());
  dGpuTriMeshOverlaps(pairs.data(), count, overlaps.data());
  dGpuTriMeshGetDistances(pairs.data(), count, dInfinity, distances.data());
  bool sameOverlaps = true, sameDistances = true;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    sameOverlaps = sameOverlaps && dGpuTriMeshOverlap(pairs[i].o1, pairs[i].o2) == overlaps[i];
    dGpuTriMeshDistance distance;
    dGpuTriMeshGetDistance(pairs[i].o1, pairs[i].o2, dInfinity, &distance);
    sameDistances = sameDistances && distance.distance == distances[i].distance &&
                    distance.triangle1 == distances[i].triangle1 && distance.triangle2 == distances[i].triangle2;
  }
  compare(sameOverlaps, "array of overlaps");
  compare(sameDistances, "array of distances");
  const dGeomID geom = geoms.ids[0];
  const std::size_t many = 100 + static_cast<std::size_t>(below(900));
  std::vector<dReal> points;
  std::vector<dGpuTriMeshRay> rays(many);
  for (dGpuTriMeshRay& ray : rays) {
    ray.length = dInfinity;
    for (int k = 0; k < 3; ++k) {
      ray.start[k] = uniform(-1.5, 1.5);
      ray.direction[k] = uniform(-1, 1);
      points.push_back(uniform(-1, 1));
    }
  }
  const int number = static_cast<int>(many), stride = static_cast<int>(3 * sizeof(dReal));
  std::vector<dGpuTriMeshClosestPoint> closest(many);
  std::vector<unsigned char> inside(many);
  std::vector<dGpuTriMeshRayHit> hits(many);
  dGeomGpuTriMeshClosestPoints(geom, points.data(), stride, number, closest.data());
  dGeomGpuTriMeshPointsInside(geom, points.data(), stride, number, inside.data());
  dGeomGpuTriMeshCastRays(geom, rays.data(), number, 0, hits.data());
  dGeomGpuTriMeshSetBackend(geom, dGPUTRIMESH_BACKEND_CPU);
  bool samePoints = true, sameRays = true;
  for (std::size_t i = 0; i < many; ++i) {
    const dVector3 point{points[3 * i], points[3 * i + 1], points[3 * i + 2], 0};
    dGpuTriMeshClosestPoint one;
    dGeomGpuTriMeshClosestPoint(geom, point, &one);
    unsigned char isInside = 0;
    dGeomGpuTriMeshPointsInside(geom, point, stride, 1, &isInside);
    samePoints = samePoints && one.distance == closest[i].distance && one.triangle == closest[i].triangle &&
                 isInside == inside[i];
    dGpuTriMeshRayHit hit;
    dGeomGpuTriMeshCastRays(geom, &rays[i], 1, 0, &hit);
    sameRays = sameRays && hit.distance == hits[i].distance && hit.triangle == hits[i].triangle;
  }
  compare(samePoints, "array of points");
  compare(sameRays, "array of rays");
  counts_.queries += 4 * pairs.size() + 6 * many;
}

}  // namespace otg::cli
