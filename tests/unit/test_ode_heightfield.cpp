// SPDX-License-Identifier: BSD-3-Clause
// Mesh geoms on ODE's heightfields: the surface that ODE's own rays meet, and the contacts of a mesh of the same
// triangles. Mirrored, wrapped, changing, from below, and in a stepping world.
#include <ode/error.h>

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <functional>
#include <string>

#include "support/catch.h"
#include "support/ode_world.h"
#include "support/step_world.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kWidth = 6, kDepth = 4;
constexpr int kColumns = 13, kRows = 9;

using Heights = std::function<double(double, double)>;

double hills(double x, double z) {
  return 0.3 * std::sin(1.3 * x + 0.4) * std::cos(1.7 * z) + 0.1 * x;
}
double steep(double x, double z) {
  return std::sin(5 * x) * std::sin(4 * z);
}

/// Data of ODE's with the samples that they point to.
struct Field {
  std::vector<double> heights;
  dHeightfieldDataID data = dGeomHeightfieldDataCreate();
  dGeomID geom;
  explicit Field(const Heights& height, bool wrap = false, double thickness = 1, int placeable = 0) {
    for (int j = 0; j < kRows; ++j) {
      for (int i = 0; i < kColumns; ++i) {
        heights.push_back(height(kWidth * (i / (kColumns - 1.0) - 0.5), kDepth * (j / (kRows - 1.0) - 0.5)));
      }
    }
    if (wrap) {  // the last samples are the first of the next period
      for (int j = 0; j < kRows; ++j) at(kColumns - 1, j) = at(0, j);
      for (int i = 0; i < kColumns; ++i) at(i, kRows - 1) = at(i, 0);
    }
    REQUIRE(dGpuTriMeshHeightfieldDataBuildDouble(data, heights.data(), 0, kWidth, kDepth, kColumns, kRows, 1, 0,
                                                  thickness, wrap) == dGPUTRIMESH_OK);
    geom = dCreateHeightfield(nullptr, data, placeable);
  }
  ~Field() {
    dGeomDestroy(geom);
    dGpuTriMeshHeightfieldDataDestroy(data);
  }
  Field(const Field&) = delete;
  Field& operator=(const Field&) = delete;
  double& at(int i, int j) { return heights[static_cast<std::size_t>(i + j * kColumns)]; }

  /// The same ground as a closed mesh, with its bottom far below.
  scenes::MeshArrays mesh(double bottom) const {
    scenes::MeshArrays mesh;
    const auto number = [](int i, int j, int k) { return static_cast<std::uint32_t>((k * kRows + j) * kColumns + i); };
    for (const bool below : {false, true}) {
      for (int j = 0; j < kRows; ++j) {
        for (int i = 0; i < kColumns; ++i) {
          mesh.vertices.push_back({float(kWidth * (i / (kColumns - 1.0) - 0.5)),
                                   float(below ? bottom : heights[static_cast<std::size_t>(i + j * kColumns)]),
                                   float(kDepth * (j / (kRows - 1.0) - 0.5))});
        }
      }
    }
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {  // cut from b to c
      mesh.triangles.push_back({{a, c, b}});
      mesh.triangles.push_back({{d, b, c}});
    };
    for (int j = 0; j + 1 < kRows; ++j) {
      for (int i = 0; i + 1 < kColumns; ++i) {
        quad(number(i, j, 0), number(i + 1, j, 0), number(i, j + 1, 0), number(i + 1, j + 1, 0));
        quad(number(i + 1, j, 1), number(i, j, 1), number(i + 1, j + 1, 1), number(i, j + 1, 1));
      }
      quad(number(0, j, 1), number(0, j, 0), number(0, j + 1, 1), number(0, j + 1, 0));
      const int last = kColumns - 1;
      quad(number(last, j, 0), number(last, j, 1), number(last, j + 1, 0), number(last, j + 1, 1));
    }
    for (int i = 0; i + 1 < kColumns; ++i) {
      quad(number(i, 0, 1), number(i + 1, 0, 1), number(i, 0, 0), number(i + 1, 0, 0));
      const int last = kRows - 1;
      quad(number(i, last, 0), number(i + 1, last, 0), number(i, last, 1), number(i + 1, last, 1));
    }
    return mesh;
  }
};

/// Where a vertical ray of ODE's meets the field.
double heightOf(dGeomID field, double x, double z) {
  const dGeomID ray = dCreateRay(nullptr, 1000);
  dGeomRaySet(ray, x, 500, z, 0, -1, 0);
  dContactGeom contact;
  REQUIRE(dCollide(field, ray, 1, &contact, sizeof contact) == 1);
  dGeomDestroy(ray);
  return contact.pos[1];
}

double deepest(const std::vector<dContactGeom>& contacts) {
  double most = 0;
  for (const dContactGeom& c : contacts) most = std::max(most, double(c.depth));
  return most;
}

/// A spike that points down, with its tip at its origin.
scenes::MeshArrays makeSpike() {
  return scenes::makeTetrahedron({0, 0, 0}, {0.004, 0.1, 0}, {-0.002, 0.1, 0.0035}, {-0.002, 0.1, -0.0035});
}

int asked = 0;
double level = 0;
dReal levelHeight(void*, int, int) {
  ++asked;
  return level;
}
std::vector<std::string> messages;
void takeMessage(int, const char* format, va_list arguments) {
  char text[512];
  std::vsnprintf(text, sizeof text, format, arguments);
  messages.emplace_back(text);
}

/// Lets a geom fall on a heightfield that is turned to have z up, and returns where its middle comes to rest.
struct Rest {
  double mu = 1;
  bool prefetches = false;
  bool onMesh = false;  ///< the ground is a mesh of the same triangles
};
Vec3d restOn(const Heights& height, const std::function<dGeomID(dSpaceID)>& make, const dMass& mass, Vec3d start,
             const Rest& how = {}) {
  StepWorld world(how.mu);
  Field field(height, false, 1, 1);
  const Data whole(field.mesh(-8));
  const dGeomID ground = how.onMesh ? dCreateGpuTriMesh(nullptr, whole.id) : field.geom;
  dMatrix3 upright;
  dRFromAxisAndAngle(upright, 1, 0, 0, M_PI / 2);
  dGeomSetRotation(ground, upright);
  dSpaceAdd(world.space(), ground);
  const dGeomID geom = make(world.space());
  const dBodyID body = world.addBody(geom, mass);
  dBodySetPosition(body, start.x, start.y, start.z);
  for (int i = 0; i < 800; ++i) {
    if (how.prefetches) dGpuTriMeshPrefetch(world.space());
    world.step(1);
  }
  const dReal* const at = dBodyGetPosition(body);
  const Vec3d end{at[0], at[1], at[2]};
  dSpaceRemove(world.space(), ground);
  if (how.onMesh) dGeomDestroy(ground);
  return end;
}

}  // namespace

TEST_CASE("the surface is the one that ODE's own rays meet, to a millionth, at every place") {
  const OdeSession session;
  const Data data(makeSpike());
  const Geom spike(data);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const bool wrap : {false, true}) {
    for (const Heights& height : {Heights(hills), Heights(steep)}) {
      const Field field(height, wrap);
      for (int i = 0; i < 500; ++i) {
        const double reach = wrap ? 3 : 0.49, x = reach * kWidth * unit(random), z = reach * kDepth * unit(random);
        const double y = heightOf(field.geom, x, z);
        // Steeper ground than the spike's sides would meet those before the tip.
        if (std::abs(heightOf(field.geom, x + 1e-4, z) - y) > 2e-3 ||
            std::abs(heightOf(field.geom, x, z + 1e-4) - y) > 2e-3)
          continue;
        dGeomSetPosition(spike.id, x, y + 1e-6, z);
        REQUIRE(test::collide(spike.id, field.geom).empty());
        dGeomSetPosition(spike.id, x, y - 1e-6, z);
        REQUIRE(!test::collide(spike.id, field.geom).empty());
      }
    }
  }
}

TEST_CASE("contacts are those of a mesh of the same triangles, in both orders, with any pose of the field") {
  const OdeSession session;
  // Of more triangles than the ground, so that they are mesh A of either query.
  const Data lump(scenes::makeLump(0.5, 3, 0.2, 4)), box(scenes::makeBox({0.8, 0.5, 0.6}, 10));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  int touching = 0;
  double worst = 0;
  for (const int placeable : {0, 1}) {
    const Field field(hills, false, 5, placeable);
    const Data whole(field.mesh(-6));
    for (const Data* data : {&lump, &box}) {
      const Geom mesh(*data), ground(whole);
      for (int i = 0; i < 60; ++i) {
        dVector3 at{0, 0, 0};
        if (placeable != 0) {
          setRandomPose(field.geom, random, 5);
          std::copy(dGeomGetPosition(field.geom), dGeomGetPosition(field.geom) + 3, at);
          dGeomSetPosition(ground.id, at[0], at[1], at[2]);
          dGeomSetRotation(ground.id, dGeomGetRotation(field.geom));
        }
        const double x = 2.2 * unit(random), z = 1.2 * unit(random);
        setRandomPose(mesh.id, random, 0);
        dVector3 place;
        dGeomGetRelPointPos(field.geom, x, hills(x, z) + 0.4 + 0.1 * unit(random), z, place);
        dGeomSetPosition(mesh.id, place[0], place[1], place[2]);
        for (const dGeomID g : {mesh.id, ground.id}) REQUIRE(dGeomGpuTriMeshForgetHistory(g) == dGPUTRIMESH_OK);
        const auto wanted = test::collide(mesh.id, ground.id), found = test::collide(mesh.id, field.geom);
        REQUIRE(sameContacts(mirrored(test::collide(field.geom, mesh.id)), found));
        INFO("pose " << i << " placeable " << placeable);
        REQUIRE(found.size() == wanted.size());
        touching += !found.empty();
        for (std::size_t k = 0; k < found.size(); ++k) {
          REQUIRE(found[k].g1 == mesh.id);
          REQUIRE(found[k].side1 >= 0);
          REQUIRE(found[k].side2 == -1);
          double nearest = 1;  // in any order: depths that are equal may change places
          for (const dContactGeom& c : wanted) {
            double d = std::abs(c.depth - found[k].depth);
            for (int n = 0; n < 3; ++n) {
              d = std::max({d, std::abs(c.pos[n] - found[k].pos[n]), std::abs(c.normal[n] - found[k].normal[n])});
            }
            nearest = std::min(nearest, d);
          }
          worst = std::max(worst, nearest);
        }
      }
    }
  }
  CHECK(touching > 100);
  CHECK(worst < 1e-4);
}

TEST_CASE("all kinds of samples give the same ground, copied or not") {
  const OdeSession session;
  const Data data(scenes::makeSphere(0.5, 3));
  const Geom ball(data);
  const int n = 5;
  std::vector<unsigned char> bytes;
  std::vector<short> shorts;
  std::vector<float> floats;
  std::vector<double> doubles;
  for (int k = 0; k < n * n; ++k) {
    const int h = (7 * k * k) % 11;
    bytes.push_back(static_cast<unsigned char>(h));
    shorts.push_back(static_cast<short>(h));
    floats.push_back(static_cast<float>(h));
    doubles.push_back(h);
  }
  const dReal scale = 0.0625, offset = -0.25;
  const dHeightfieldDataID field = dGeomHeightfieldDataCreate();
  const dGeomID ground = dCreateHeightfield(nullptr, field, 0);
  struct Ask {
    static dReal height(void* heights, int i, int j) { return static_cast<double*>(heights)[i + 5 * j]; }
  };
  const auto contacts = [&] {
    dGeomGpuTriMeshForgetHistory(ball.id);
    return test::collide(ball.id, ground);
  };
  dGeomSetPosition(ball.id, 0.3, 0.4, -0.7);
  REQUIRE(dGpuTriMeshHeightfieldDataBuildDouble(field, doubles.data(), 0, 4, 4, n, n, scale, offset, 1, 0) == 0);
  const auto wanted = contacts();
  REQUIRE(!wanted.empty());
  for (const int copy : {0, 1}) {
    REQUIRE(dGpuTriMeshHeightfieldDataBuildByte(field, bytes.data(), copy, 4, 4, n, n, scale, offset, 1, 0) == 0);
    CHECK(sameContacts(contacts(), wanted));
    REQUIRE(dGpuTriMeshHeightfieldDataBuildShort(field, shorts.data(), copy, 4, 4, n, n, scale, offset, 1, 0) == 0);
    CHECK(sameContacts(contacts(), wanted));
    REQUIRE(dGpuTriMeshHeightfieldDataBuildSingle(field, floats.data(), copy, 4, 4, n, n, scale, offset, 1, 0) == 0);
    CHECK(sameContacts(contacts(), wanted));
  }
  REQUIRE(dGpuTriMeshHeightfieldDataBuildCallback(field, doubles.data(), &Ask::height, 4, 4, n, n, scale, offset, 1,
                                                  0) == 0);
  CHECK(sameContacts(contacts(), wanted));
  // An array that is not copied may change; one that was copied may go.
  REQUIRE(dGpuTriMeshHeightfieldDataBuildSingle(field, floats.data(), 0, 4, 4, n, n, scale, offset, 1, 0) == 0);
  CHECK(sameContacts(contacts(), wanted));
  for (float& h : floats) h += 4;
  CHECK(deepest(contacts()) > deepest(wanted) + 0.1);
  for (float& h : floats) h -= 4;
  CHECK(sameContacts(contacts(), wanted));
  REQUIRE(dGpuTriMeshHeightfieldDataBuildSingle(field, floats.data(), 1, 4, 4, n, n, scale, offset, 1, 0) == 0);
  for (float& h : floats) h += 4;
  CHECK(sameContacts(contacts(), wanted));
  dGeomDestroy(ground);
  dGpuTriMeshHeightfieldDataDestroy(field);
}

TEST_CASE("a wrapped field repeats itself, however far away") {
  const OdeSession session;
  const Field field(hills, true);
  const Data data(scenes::makeLump(0.4, 3, 0.2, 4));
  const Geom mesh(data);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  int touching = 0;
  for (int i = 0; i < 40; ++i) {
    const double x = 3 * unit(random), z = 2 * unit(random), y = heightOf(field.geom, x, z) + 0.3;
    setRandomPose(mesh.id, random, 0);
    dGeomSetPosition(mesh.id, x, y, z);
    dGeomGpuTriMeshForgetHistory(mesh.id);
    const auto here = test::collide(mesh.id, field.geom);
    touching += !here.empty();
    for (const int periods : {-1, 3, 100000}) {
      const double dx = kWidth * periods, dz = -kDepth * periods;
      dGeomSetPosition(mesh.id, x + dx, y, z + dz);
      dGeomGpuTriMeshForgetHistory(mesh.id);
      const auto there = test::collide(mesh.id, field.geom);
      INFO("pose " << i << " periods " << periods);
      REQUIRE(there.size() == here.size());
      CHECK(deepest(there) == Approx(deepest(here)).margin(1e-6));
      double sumHere = 0, sumThere = 0;
      for (std::size_t k = 0; k < here.size(); ++k) {
        sumHere += here[k].pos[0] + here[k].pos[2];
        sumThere += there[k].pos[0] - dx + there[k].pos[2] - dz;
      }
      CHECK(sumThere == Approx(sumHere).margin(1e-4));
    }
  }
  CHECK(touching > 30);
}

TEST_CASE("bodies leave the ground through its surface, and meet its walls and its bottom from outside") {
  const OdeSession session;
  const Data data(scenes::makeBox({0.4, 0.4, 0.4}, 2));
  const Geom box(data);
  for (const double thickness : {0.0, 0.05, 1.0}) {
    INFO("thickness " << thickness);
    const Field field([](double, double) { return 0.0; }, false, thickness);
    for (const double sunk : {0.01, 0.1, 0.3, 0.39}) {
      dGeomSetPosition(box.id, 0.1, 0.2 - sunk, 0.1);
      dGeomGpuTriMeshForgetHistory(box.id);
      const auto contacts = test::collide(box.id, field.geom);
      const bool fromBelow = 0.2 - sunk < -thickness;
      INFO("sunk " << sunk);
      REQUIRE(!contacts.empty());
      for (const dContactGeom& c : contacts) CHECK(c.normal[1] == Approx(fromBelow ? -1 : 1));
      if (!fromBelow) CHECK(deepest(contacts) == Approx(sunk).margin(1e-5));
    }
    // Wholly inside: up, as far as it takes.
    if (thickness > 0.9) {
      dGeomSetPosition(box.id, 0.1, -0.5, 0.1);
      dGeomGpuTriMeshForgetHistory(box.id);
      const auto contacts = test::collide(box.id, field.geom);
      REQUIRE(!contacts.empty());
      for (const dContactGeom& c : contacts) CHECK(c.normal[1] > 0.99);
    }
    // The bottom, the walls, and beyond them.
    dGeomSetPosition(box.id, 0, -thickness - 0.21, 0);
    dGeomGpuTriMeshForgetHistory(box.id);
    CHECK(test::collide(box.id, field.geom).empty());
    if (thickness >= 0.05) {
      dGeomSetPosition(box.id, 0, -thickness - 0.19, 0);
      dGeomGpuTriMeshForgetHistory(box.id);
      for (const dContactGeom& c : test::collide(box.id, field.geom)) {
        CHECK(c.normal[1] == Approx(-1));
        CHECK(c.depth == Approx(0.01).margin(1e-5));
      }
      CHECK(!test::collide(box.id, field.geom).empty());
    }
    if (thickness > 0.9) {
      dGeomSetPosition(box.id, kWidth / 2 + 0.19, -0.5, 0);
      dGeomGpuTriMeshForgetHistory(box.id);
      const auto contacts = test::collide(box.id, field.geom);
      REQUIRE(!contacts.empty());
      for (const dContactGeom& c : contacts) CHECK(c.normal[0] == Approx(1));
    }
    dGeomSetPosition(box.id, kWidth / 2 + 0.21, -0.1, 0);
    CHECK(test::collide(box.id, field.geom).empty());
    dGeomSetPosition(box.id, 0, -0.1, -kDepth / 2 - 0.21);
    CHECK(test::collide(box.id, field.geom).empty());
  }
}

TEST_CASE("a callback is asked at each collision, and what it says then holds") {
  const OdeSession session;
  const Data data(scenes::makeBox({0.4, 0.4, 0.4}));
  const Geom box(data);
  const dHeightfieldDataID field = dGeomHeightfieldDataCreate();
  REQUIRE(dGpuTriMeshHeightfieldDataBuildCallback(field, nullptr, &levelHeight, 1024, 1024, 1025, 1025, 1, 0, 1, 0) ==
          dGPUTRIMESH_OK);
  const dGeomID ground = dCreateHeightfield(nullptr, field, 0);
  dGeomSetPosition(box.id, 5.3, 0.15, -200.6);
  for (const double height : {0.0, 0.02, -0.04, -0.06, 0.0}) {
    level = height;
    asked = 0;
    const auto contacts = test::collide(box.id, ground);
    INFO("level " << height);
    if (height < -0.05) {
      CHECK(contacts.empty());
    } else {
      CHECK(deepest(contacts) == Approx(height + 0.05).margin(1e-6));
    }
    CHECK(asked > 0);
    CHECK(asked < 200);  // of a million samples those under the box
  }
  // Heights that are no numbers.
  level = std::nan("");
  dGpuTriMeshGetError();
  CHECK(test::collide(box.id, ground).empty());
  level = 0;
  CHECK(!test::collide(box.id, ground).empty());
  dGeomDestroy(ground);
  dGpuTriMeshHeightfieldDataDestroy(field);
}

TEST_CASE("a heightfield that was not described is reported once, and can be described afterwards") {
  const OdeSession session;
  const Data data(scenes::makeBox({1, 1, 1}));
  const Geom box(data);
  const float heights[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
  const dHeightfieldDataID field = dGeomHeightfieldDataCreate();
  dGeomHeightfieldDataBuildSingle(field, heights, 0, 4, 4, 3, 3, 1, 0, 1, 0);
  const dGeomID ground = dCreateHeightfield(nullptr, field, 0);
  dGeomSetPosition(box.id, 0, 0.4, 0);
  messages.clear();
  dSetMessageHandler(&takeMessage);
  for (int i = 0; i < 3; ++i) {
    dGpuTriMeshGetError();
    CHECK(test::collide(box.id, ground).empty());
    CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_UNSUPPORTED);
  }
  dSetMessageHandler(nullptr);
  REQUIRE(messages.size() == 1);
  CHECK(messages[0].find("dGpuTriMeshHeightfieldDataDescribe") != std::string::npos);
  dGpuTriMeshHeightfield description;
  dGpuTriMeshHeightfieldInit(&description);
  description.type = dGPUTRIMESH_HEIGHTS_SINGLE;
  description.heights = heights;
  description.width = description.depth = 4;
  description.width_samples = description.depth_samples = 3;
  description.thickness = 1;
  REQUIRE(dGpuTriMeshHeightfieldDataDescribe(field, &description) == dGPUTRIMESH_OK);
  CHECK(deepest(test::collide(box.id, ground)) == Approx(0.1));
  dGpuTriMeshHeightfieldDataForget(field);
  dSetMessageHandler(&takeMessage);
  CHECK(test::collide(box.id, ground).empty());
  dSetMessageHandler(nullptr);
  // Arguments that ODE would abort at.
  CHECK(dGpuTriMeshHeightfieldDataDescribe(nullptr, &description) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshHeightfieldDataDescribe(field, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  for (int i = 0; i < 6; ++i) {
    dGpuTriMeshHeightfield bad = description;
    if (i == 0) bad.size = 1;
    if (i == 1) bad.type = 5;
    if (i == 2) bad.heights = nullptr;
    if (i == 3) bad.width = 0;
    if (i == 4) bad.depth_samples = 1;
    if (i == 5) bad.scale = dInfinity;
    CHECK(dGpuTriMeshHeightfieldDataDescribe(field, &bad) == dGPUTRIMESH_ERROR_ARGUMENT);
  }
  CHECK(dGpuTriMeshHeightfieldDataBuildCallback(field, nullptr, nullptr, 4, 4, 3, 3, 1, 0, 1, 0) ==
        dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshHeightfieldDataBuildSingle(nullptr, heights, 0, 4, 4, 3, 3, 1, 0, 1, 0) ==
        dGPUTRIMESH_ERROR_ARGUMENT);
  dGpuTriMeshHeightfieldDataDestroy(nullptr);
  dGeomDestroy(ground);
  dGpuTriMeshHeightfieldDataDestroy(field);
}

TEST_CASE("balls and boxes that are meshes come to rest where ODE's own do, with and without prefetching") {
  const OdeSession session;
  const Heights slope = [](double x, double z) { return 0.05 * x - 0.02 * z; };
  const Heights slab = [](double, double) { return 0.25; };
  const Data ball(scenes::makeSphere(0.4, 5)), box(scenes::makeBox({0.6, 0.4, 0.5}, 2));
  dMass round, square;
  dMassSetSphere(&round, 1, 0.4);
  dMassSetBox(&square, 1, 0.6, 0.4, 0.5);
  const auto meshOf = [](const Data& data) {
    return [&data](dSpaceID space) { return dCreateGpuTriMesh(space, data.id); };
  };
  const Vec3d start{1.3, 0.2, 0.8};
  const auto sphere = [](dSpaceID s) { return dCreateSphere(s, 0.4); };
  CHECK(restOn(slab, meshOf(ball), round, start).z == Approx(restOn(slab, sphere, round, start).z).margin(3e-4));
  // Rolling and sliding down a slope of many triangles, 4 s long.
  const Vec3d ballEnd = restOn(slope, meshOf(ball), round, start);
  const Vec3d onMesh = restOn(slope, meshOf(ball), round, start, {1, false, true});
  CHECK(ballEnd.x < start.x - 2);
  CHECK(ballEnd.x == Approx(onMesh.x).margin(0.02));
  CHECK(ballEnd.y == Approx(onMesh.y).margin(0.02));
  CHECK(ballEnd.z == Approx(onMesh.z).margin(0.002));
  for (const double mu : {0.0, 0.02}) {
    const Vec3d slid = restOn(slope, meshOf(box), square, start, {mu});
    const Vec3d native = restOn(slope, [](dSpaceID s) { return dCreateBox(s, 0.6, 0.4, 0.5); }, square, start, {mu});
    CHECK(slid.x < start.x - 2);
    CHECK(slid.x == Approx(native.x).margin(1e-4));
    CHECK(slid.y == Approx(native.y).margin(1e-4));
    CHECK(slid.z == Approx(native.z).margin(1e-4));
  }
  const Vec3d dBoxEnd = restOn(
      slab, [](dSpaceID s) { return dCreateBox(s, 0.6, 0.4, 0.5); }, square, start);
  const Vec3d boxEnd = restOn(slab, meshOf(box), square, start);
  CHECK(boxEnd.z == Approx(dBoxEnd.z).margin(1e-3));
  CHECK(boxEnd.x == Approx(start.x).margin(1e-3));
  CHECK(boxEnd.y == Approx(start.y).margin(1e-3));
  const Vec3d ahead = restOn(slope, meshOf(ball), round, start, {1, true});
  CHECK(ahead.x == ballEnd.x);
  CHECK(ahead.y == ballEnd.y);
  CHECK(ahead.z == ballEnd.z);
}

TEST_CASE("an open mesh meets the ground with its triangles") {
  const OdeSession session;
  const Field field([](double, double) { return 0.0; });
  scenes::MeshArrays sheet = scenes::makeBox({1, 1, 1}, 2);
  sheet.triangles.resize(sheet.triangles.size() - 3);
  const Data data(sheet);
  const Geom open(data);
  dGeomSetPosition(open.id, 0.1, 0.45, 0.1);
  const auto contacts = test::collide(open.id, field.geom);
  REQUIRE(!contacts.empty());
  for (const dContactGeom& c : contacts) CHECK(c.normal[1] > 0.9);
  CHECK(deepest(contacts) == Approx(0.05).margin(1e-3));
  dGeomSetPosition(open.id, 0.1, 0.51, 0.1);
  CHECK(test::collide(open.id, field.geom).empty());
}
