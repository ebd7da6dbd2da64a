// SPDX-License-Identifier: BSD-3-Clause
// A mesh with a heightfield and with another mesh against the mirror image of the scene. (Planes and rays are in
// test_ode_primitives.cpp, the other shapes in test_ode_shapes.cpp.)
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/vectors.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/mirror.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

Vec3d imageOf(Mirror mirror, const dReal* v) {
  return image(mirror, Vec3d{v[0], v[1], v[2]});
}

using Heights = std::function<double(double, double)>;

/// ODE cuts all cells alike, from the sample of the higher x to that of the higher z: the image through x = z is cut as
/// a mirrored surface has to be, the one through x = 0 is not.
struct Field {
  std::vector<double> heights;
  dHeightfieldDataID data = dGeomHeightfieldDataCreate();
  dGeomID geom;
  Field(const Heights& height, double width, double depth, int columns, int rows) {
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        heights.push_back(height(width * (i / (columns - 1.0) - 0.5), depth * (j / (rows - 1.0) - 0.5)));
      }
    }
    REQUIRE(dGpuTriMeshHeightfieldDataBuildDouble(data, heights.data(), 0, width, depth, columns, rows, 1, 0, 5, 0) ==
            dGPUTRIMESH_OK);
    geom = dCreateHeightfield(nullptr, data, 0);
  }
  ~Field() {
    dGeomDestroy(geom);
    dGpuTriMeshHeightfieldDataDestroy(data);
  }
  Field(const Field&) = delete;
  Field& operator=(const Field&) = delete;
};

double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

double difference(Mirror mirror, const dContactGeom& a, const dContactGeom& b) {
  const Vec3d p = otgSub(imageOf(mirror, a.pos), {b.pos[0], b.pos[1], b.pos[2]});
  const Vec3d n = otgSub(imageOf(mirror, a.normal), {b.normal[0], b.normal[1], b.normal[2]});
  return std::max({norm(p), norm(n), std::abs(double(a.depth - b.depth))});
}

/// Bodies at rest overlap by far less: up to here depths may not differ. Of places that are alike within the model's
/// steps (docs/contacts.md: of ranks, of cells of large regions) another may be chosen. A mirrored mesh is numbered
/// otherwise, and its cells begin at the other end.
constexpr double kShallow = 0.05;

/// How far contacts and those of the image are apart, pose by pose.
class Comparison {
 public:
  explicit Comparison(Mirror mirror) : mirror_(mirror) {}

  void add(const std::vector<dContactGeom>& contacts, const std::vector<dContactGeom>& images) {
    REQUIRE(contacts.empty() == images.empty());
    if (contacts.empty()) return;
    const auto shallower = [](const dContactGeom& a, const dContactGeom& b) { return a.depth < b.depth; };
    const dContactGeom& a = *std::max_element(contacts.begin(), contacts.end(), shallower);
    const dContactGeom& b = *std::max_element(images.begin(), images.end(), shallower);
    depths.push_back(std::abs(double(a.depth - b.depth)));
    if (a.depth > kShallow) return;
    ++shallow;
    worstOfShallow = std::max(worstOfShallow, depths.back());
    bool same = contacts.size() == images.size();
    for (const dContactGeom& c : contacts) {
      same = same && std::any_of(images.begin(), images.end(),
                                 [&](const dContactGeom& d) { return difference(mirror_, c, d) < 1e-9; });
    }
    allSame += same;
  }

  std::vector<double> depths;    ///< of the deepest, of all poses
  int shallow = 0, allSame = 0;  ///< poses; those in which every contact has its image
  double worstOfShallow = 0;     ///< of the deepest

 private:
  Mirror mirror_;
};

double hills(double x, double z) {
  return 0.3 * std::sin(1.3 * x + 0.4) * std::cos(1.7 * z) + 0.1 * x;
}
double waves(double x, double) {
  return 0.3 * std::sin(1.3 * x + 0.4) + 0.1 * x;
}

std::vector<scenes::MeshArrays> bodies() {
  return {scenes::makeLump(0.5, 2, 0.2, 4), scenes::makeBox({0.8, 0.5, 0.6}, 2), scenes::makeSphere(0.4, 3)};
}

Comparison compareOn(Mirror mirror, const Heights& height, const scenes::MeshArrays& body, const Field& ground,
                     const Field& mirroredGround) {
  const Data data(body), mirroredData(image(mirror, body));
  const Geom mesh(data), other(mirroredData);
  Draw draw(11);
  Comparison comparison(mirror);
  for (int i = 0; i < 900; ++i) {
    INFO("pose " << i);
    Vec3d at{draw.uniform(-2.2, 2.2), 0, draw.uniform(-1.2, 1.2)};
    at.y = height(at.x, at.z) + draw.uniform(0.3, 0.5);
    const double angle = draw.uniform(-3, 3);  // first: compilers differ in which argument they make first
    const Transformd pose = makePose(draw.direction(), angle, at);
    setPose(mesh.id, pose);
    setPose(other.id, image(mirror, pose));
    for (const dGeomID g : {mesh.id, other.id}) REQUIRE(dGeomGpuTriMeshForgetHistory(g) == dGPUTRIMESH_OK);
    comparison.add(test::collide(mesh.id, ground.geom), test::collide(other.id, mirroredGround.geom));
  }
  CHECK(comparison.depths.size() > 300);
  return comparison;
}

}  // namespace

TEST_CASE("a mesh on a mirrored heightfield has mirrored contacts") {
  const OdeSession session;
  const Field ground(hills, 6, 4, 13, 9);
  const Field mirroredGround([](double x, double z) { return hills(z, x); }, 4, 6, 9, 13);
  for (const scenes::MeshArrays& body : bodies()) {
    const Comparison found = compareOn(Mirror::kDiagonal, hills, body, ground, mirroredGround);
    INFO(body.vertices.size() << " vertices, " << found.shallow << " of " << found.depths.size()
                              << " poses: " << found.allSame << " " << found.worstOfShallow << ", all "
                              << quantile(found.depths, 0.98) << " / " << quantile(found.depths, 1));
    CHECK(found.shallow > 60);
    CHECK(found.worstOfShallow < 1e-9);
    CHECK(found.allSame > 0.98 * found.shallow);
    CHECK(quantile(found.depths, 0.98) < 1e-9);
    CHECK(quantile(found.depths, 1) < 0.02);
  }
}

TEST_CASE("where cells are flat it does not matter how they are cut") {
  const OdeSession session;
  const Field ground(waves, 6, 4, 13, 9);
  const Field mirroredGround([](double x, double z) { return waves(-x, z); }, 6, 4, 13, 9);
  for (const scenes::MeshArrays& body : bodies()) {
    const Comparison found = compareOn(Mirror::kAcross, waves, body, ground, mirroredGround);
    // The triangles are others, and with them the pieces by which normals are weighed.
    INFO(body.vertices.size() << " vertices, " << found.shallow << " of " << found.depths.size() << " poses: "
                              << found.allSame << " " << found.worstOfShallow << ", all " << quantile(found.depths, 0.5)
                              << " / " << quantile(found.depths, 0.98) << " / " << quantile(found.depths, 1));
    CHECK(found.shallow > 60);
    CHECK(found.worstOfShallow < 2e-4);
    CHECK(quantile(found.depths, 0.5) < 1e-6);
    CHECK(quantile(found.depths, 0.98) < 5e-4);
    CHECK(quantile(found.depths, 1) < 0.02);
  }
}

TEST_CASE("two meshes that are mirrored have mirrored contacts") {
  const OdeSession session;
  const scenes::MeshArrays ground = scenes::makeLump(0.6, 3, 0.3, 3);
  for (const Mirror mirror : {Mirror::kDiagonal, Mirror::kAcross}) {
    for (const scenes::MeshArrays& body : bodies()) {
      const Data first(ground), second(body), firstImage(image(mirror, ground)), secondImage(image(mirror, body));
      const Geom a(first), b(second), c(firstImage), d(secondImage);
      Draw draw(12);
      Comparison comparison(mirror);
      for (int i = 0; i < 900; ++i) {
        INFO("pose " << i);
        // One by one: compilers differ in which argument they make first.
        const Vec3d at = draw.inBox(0.3);
        const double angle = draw.uniform(-3, 3);
        const Transformd pose = makePose(draw.direction(), angle, at);
        const double reach = draw.uniform(0.85, 1.05);
        const Vec3d other = otgScale(draw.direction(), reach);
        const double turn = draw.uniform(-3, 3);
        const Transformd away = makePose(draw.direction(), turn, other);
        setPose(a.id, pose);
        setPose(b.id, away);
        setPose(c.id, image(mirror, pose));
        setPose(d.id, image(mirror, away));
        for (const dGeomID g : {a.id, b.id, c.id, d.id}) REQUIRE(dGeomGpuTriMeshForgetHistory(g) == dGPUTRIMESH_OK);
        comparison.add(test::collide(a.id, b.id), test::collide(c.id, d.id));
      }
      INFO(body.vertices.size() << " vertices, " << comparison.shallow << " of " << comparison.depths.size()
                                << " poses: " << comparison.allSame << " " << comparison.worstOfShallow << ", all "
                                << quantile(comparison.depths, 0.85) << " / " << quantile(comparison.depths, 0.97));
      CHECK(comparison.shallow > 60);
      CHECK(comparison.worstOfShallow < 1e-9);
      CHECK(comparison.allSame > 0.98 * comparison.shallow);
      CHECK(quantile(comparison.depths, 0.85) < 0.005);
      CHECK(quantile(comparison.depths, 0.97) < 0.02);
    }
  }
}
