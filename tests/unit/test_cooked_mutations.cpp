// SPDX-License-Identifier: BSD-3-Clause
// Cooked meshes that somebody changed on purpose and sealed again. What is loaded all the same is a mesh whose parts
// agree with each other, checked here a second time and in another way. Every query of it ends without harm. Meant for
// AddressSanitizer.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "bvh/cooked_mesh.h"
#include "support/catch.h"
#include "support/cooked_file.h"
#include "support/mesh_samples.h"
#include "support/ode_world.h"
#include "support/part_of.h"

using namespace otg;
using namespace otg::test;

namespace {

struct Sample {
  const char* name;
  Bytes bytes;
};

Bytes cooked(const scenes::MeshArrays& arrays, MeshOrder order = MeshOrder::kLocal) {
  return cookMesh(CollisionMesh(buildTriMesh(arrays.input(), {}, order).mesh, BuildStrategy::kSah));
}

void append(scenes::MeshArrays& to, const scenes::MeshArrays& from, float shift) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  for (const Vec3f& v : from.vertices) to.vertices.push_back({v.x + shift, v.y, v.z});
  for (const Triangle& t : from.triangles) to.triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
}

/// A closed body, two bodies with triangles that are flat, double and alone, a body that touches itself, open ground.
std::vector<Sample> hostileSamples() {
  const scenes::MeshArrays lump = scenes::makeLump(1, 1, 0.2, 3);
  scenes::MeshArrays mixed = scenes::makeBox({1, 1, 1});
  append(mixed, scenes::makeBox({0.5, 0.5, 0.5}), 2);
  mixed.triangles.push_back({{0, 0, 1}});
  mixed.triangles.push_back(mixed.triangles[3]);
  mixed.triangles.push_back({{0, 9, 12}});
  mixed.vertices.push_back({7, 7, 7});
  scenes::MeshArrays touching = scenes::makeBox({1, 1, 1});
  append(touching, scenes::makeBox({1, 1, 1}), 1);
  return {{"lump", cooked(lump)},
          {"lump in its own order", cooked(lump, MeshOrder::kInput)},
          {"bodies and leftovers", cooked(mixed)},
          {"touching itself", cooked(touching)},
          {"ground", cooked(scenes::makeGround(4, 0, 4, [](double x, double y) { return 0.1 * x * y; }))}};
}

/// Some words of the sections changed, most often to a number that another element of the section has.
Bytes mutated(const Bytes& from, const std::vector<Section>& sections, std::mt19937& random) {
  Bytes bytes = from;
  for (std::uint32_t left = 1 + random() % 3; left > 0; --left) {
    const Section& section = sections[random() % sections.size()];
    if (section.size < 4) continue;
    const std::size_t at = section.at + random() % (section.size / 4) * 4;
    const std::uint32_t before = read32(bytes, at);
    switch (random() % 8) {
      case 0:
      case 1:
        write32(bytes, at, 0xffffffffu);
        break;
      case 2:
        write32(bytes, at, random() % 100);
        break;
      case 3:
        write32(bytes, at, before + (random() % 2 == 0 ? 1 : 0xffffffffu));
        break;
      case 4:
        write32(bytes, at, before ^ (1u << random() % 32));
        break;
      case 5:
        write32(bytes, at, random() % 2 == 0 ? 0x7f7fffffu : 0xff7fffffu);  // the largest floats
        break;
      default: {  // exchanged with another word of the section
        const std::size_t other = section.at + random() % (section.size / 4) * 4;
        write32(bytes, at, read32(bytes, other));
        write32(bytes, other, before);
      }
    }
  }
  seal(bytes);
  return bytes;
}

/// What is wrong with the topology of a mesh, looked up in maps.
std::string topologyFault(const TriMesh& mesh) {
  const Topology& topology = mesh.topology();
  using Point = std::uint32_t;
  struct Use {
    std::uint32_t halfEdge;
    bool forward;
  };
  for (std::uint32_t v = 0; v < topology.weld.size(); ++v) {
    if (mesh.vertices()[v] != mesh.vertices()[topology.weld[v]]) return "one point at two places";
  }
  std::map<std::uint32_t, std::vector<Use>> uses;
  std::map<std::uint32_t, std::set<std::uint32_t>> neighbours;
  std::set<std::uint32_t> components, closed;
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    const Triangle& corners = mesh.triangles()[t];
    Point p[3];
    for (int k = 0; k < 3; ++k) p[k] = topology.weld[corners.v[k]];
    const bool whole = std::set<Point>(p, p + 3).size() == 3;
    if (whole != (topology.componentOf[t] != kNone)) return "a triangle in no component";
    if (whole) components.insert(topology.componentOf[t]);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t edge = topology.edgeOf[3 * t + k];
      if (whole != (edge != kNone)) return "a half-edge without edge";
      if (!whole) continue;
      const Topology::Edge& ends = topology.edges[edge];
      if (std::set<Point>{ends.a, ends.b} != std::set<Point>{p[k], p[(k + 1) % 3]}) return "an edge between others";
      uses[edge].push_back({3 * t + k, ends.a == p[k]});
    }
  }
  if (uses.size() != topology.edgeCount()) return "an edge that nothing uses";
  if (components.size() != topology.componentCount()) return "a component without triangles";
  closed = components;
  for (const auto& [edge, list] : uses) {
    const bool pair = list.size() == 2 && list[0].forward != list[1].forward;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::uint32_t twin = pair ? list[1 - i].halfEdge : kNone;
      if (topology.twin[list[i].halfEdge] != twin) return "a wrong twin";
      neighbours[list[0].halfEdge / 3].insert(list[i].halfEdge / 3);
      neighbours[list[i].halfEdge / 3].insert(list[0].halfEdge / 3);
      if (!pair) closed.erase(topology.componentOf[list[i].halfEdge / 3]);
    }
  }
  std::set<std::uint32_t> left = components, seen;
  for (const auto& [start, around] : neighbours) {
    if (seen.count(start) != 0) continue;
    const std::uint32_t component = topology.componentOf[start];
    if (left.erase(component) == 0) return "a component in two pieces";
    std::vector<std::uint32_t> open{start};
    seen.insert(start);
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      if (topology.componentOf[t] != component) return "two components that hang together";
      for (const std::uint32_t n : neighbours[t]) {
        if (seen.insert(n).second) open.push_back(n);
      }
    }
  }
  for (std::uint32_t c = 0; c < topology.componentCount(); ++c) {
    if ((topology.componentClosed[c] != 0) != (closed.count(c) != 0)) return "a component wrongly closed";
  }
  return {};
}

std::string fault(const CollisionMesh& mesh) {
  const TriMesh& m = mesh.mesh();
  if (std::string wrong = topologyFault(m); !wrong.empty()) return wrong;
  if (std::string wrong = validateTree(mesh.tree(), m); !wrong.empty()) return wrong;
  for (std::uint32_t t = 0; t < m.triangleCount(); ++t) {
    for (const std::uint32_t v : m.triangles()[t].v) {
      const Vec3f& p = m.vertices()[v];
      const double d = std::hypot(double{p.x} - m.center().x, double{p.y} - m.center().y, double{p.z} - m.center().z);
      if (!(d <= double{m.radius()} * (1 + 1e-12))) return "a vertex beyond the radius";
      if (p.x < m.boundsMin().x || p.x > m.boundsMax().x) return "a vertex beyond the bounds";
    }
  }
  const ValidationReport& report = m.report();
  const bool noLooseEdge = std::all_of(m.topology().edgeOf.begin(), m.topology().edgeOf.end(), [&](const auto& e) {
    return e == kNone || m.topology().twin[static_cast<std::size_t>(&e - m.topology().edgeOf.begin())] != kNone;
  });
  if (report.solid && !noLooseEdge) return "a solid with a hole";
  const MassProperties& mass = m.massProperties();
  const bool finite = std::isfinite(mass.volume) && std::isfinite(mass.area) && mass.centerOfMass.allFinite() &&
                      mass.inertia.allFinite();
  if (!finite) return "a mass that is not finite";
  return {};
}

/// Geoms that each mesh is put to.
class Queries {
 public:
  Queries()
      : boxData_(scenes::makeLump(0.8, 1, 0.2, 9)),
        box_(boxData_),
        shapes_{dCreateSphere(nullptr, 0.5), dCreateBox(nullptr, 1, 0.7, 0.5), dCreateCapsule(nullptr, 0.3, 0.8),
                dCreatePlane(nullptr, 0, 0, 1, 0), dCreateRay(nullptr, 5)} {
    dGeomRaySet(shapes_[4], -3, 0.1, 0.2, 1, 0.01, 0.02);
    dGeomSetPosition(box_.id, 0.6, 0.1, 0.2);
  }
  ~Queries() {
    for (const dGeomID shape : shapes_) dGeomDestroy(shape);
  }
  Queries(const Queries&) = delete;
  Queries& operator=(const Queries&) = delete;

  void askOnce(dGpuTriMeshDataID data) {
    const dGeomID a = dCreateGpuTriMesh(nullptr, data);
    meet(a, box_.id);
    dGeomDestroy(a);
  }
  void ask(dGpuTriMeshDataID data) {
    const dGeomID a = dCreateGpuTriMesh(nullptr, data), b = dCreateGpuTriMesh(nullptr, data);
    dGeomSetPosition(b, 0.3, -0.2, 0.1);
    meet(a, box_.id);
    meet(box_.id, a);
    meet(a, b);
    for (const dGeomID shape : shapes_) meet(a, shape);
    usePairwise(a);
    meet(a, box_.id);
    dGeomGpuTriMeshSetScale(b, -1, 1.5, 0.5);
    meet(b, box_.id);
    const dVector3 point = {0.2, 0.3, 0.9, 0};
    dGpuTriMeshClosestPoint nearest;
    CHECK(dGeomGpuTriMeshClosestPoint(a, point, &nearest) == dGPUTRIMESH_OK);
    dGeomDestroy(a);
    dGeomDestroy(b);
  }

 private:
  static void meet(dGeomID a, dGeomID b) {
    for (const dContactGeom& c : test::collide(a, b, 64)) {
      bool finite = std::isfinite(c.depth);
      for (int k = 0; k < 3; ++k) finite = finite && std::isfinite(c.pos[k]) && std::isfinite(c.normal[k]);
      CHECK(finite);
    }
  }
  const Data boxData_;
  const Geom box_;
  dGeomID shapes_[5];
};

/// Some vertices, then all of them, in new places.
void move(dGpuTriMeshDataID data, std::size_t vertices, std::mt19937& random) {
  std::vector<float> places(3 * vertices);
  for (float& x : places) x = static_cast<float>(random() % 1000) / 500 - 1;
  CHECK(dGpuTriMeshDataUpdateRangeSingle(data, places.data(), 0, 0, 2) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshDataUpdateVerticesSingle(data, places.data(), 0, static_cast<int>(vertices)) == dGPUTRIMESH_OK);
}

}  // namespace

TEST_CASE("mutations under a checksum that is right make a sound mesh or none") {
  const OdeSession session;
  Queries queries;
  std::mt19937 random(20);
  int accepted = 0, refused = 0;
  const int rounds = partOf(2000);
  for (const Sample& sample : hostileSamples()) {
    const std::vector<Section> sections = sectionsOf(sample.bytes);
    for (int round = 0; round < rounds; ++round) {
      const Bytes bytes = mutated(sample.bytes, sections, random);
      INFO(sample.name << ", mutation " << round);
      const UncookedMesh uncooked = uncookMesh(bytes);
      REQUIRE((uncooked.mesh == nullptr) == !uncooked.error.empty());
      if (uncooked.mesh == nullptr) {
        ++refused;
        continue;
      }
      ++accepted;
      REQUIRE(fault(*uncooked.mesh) == "");
      const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
      REQUIRE(dGpuTriMeshDataUncook(data, bytes.data(), bytes.size()) == dGPUTRIMESH_OK);
      queries.ask(data);
      // Vertices have a number each, however many there are said to be.
      if (const std::size_t vertices = uncooked.mesh->mesh().inputVertexCount(); vertices < 1000) {
        move(data, vertices, random);
        queries.askOnce(data);
      }
      dGpuTriMeshDataDestroy(data);
    }
  }
  CHECK(refused > 5 * rounds / 2);  // of all 5 * rounds
  CHECK(accepted > rounds / 4);     // such as another normal of no consequence
}
