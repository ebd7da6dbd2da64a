// SPDX-License-Identifier: BSD-3-Clause
// Nearest points, distances, overlap and rays, against every triangle tried one by one in double.
#include <cmath>
#include <limits>
#include <thread>

#include "base/vectors.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Corners = std::array<Vec3d, 3>;

Vec3d toVec(const dReal* p) {
  return {p[0], p[1], p[2]};
}

std::vector<Corners> trianglesOf(dGeomID g) {
  std::vector<Corners> out(static_cast<std::size_t>(dGeomGpuTriMeshGetTriangleCount(g)));
  for (std::size_t i = 0; i < out.size(); ++i) {
    dVector3 v[3];
    REQUIRE(dGeomGpuTriMeshGetTriangle(g, static_cast<int>(i), &v[0], &v[1], &v[2]) == dGPUTRIMESH_OK);
    for (std::size_t k = 0; k < 3; ++k) out[i][k] = toVec(v[k]);
  }
  return out;
}

double pointToSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d ab = otgSub(b, a);
  const double t = std::clamp(otgDot(otgSub(p, a), ab) / otgDot(ab, ab), 0.0, 1.0);
  return norm(otgSub(p, otgAdd(a, otgScale(ab, t))));
}

/// The foot on the plane if it lies inside all three edges, else the nearest edge.
double pointToTriangle(const Vec3d& p, const Corners& t) {
  const Vec3d n = otgCross(otgSub(t[1], t[0]), otgSub(t[2], t[0]));
  bool above = true;
  double nearest = kInfinity;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &a = t[k], &b = t[(k + 1) % 3];
    above = above && otgDot(otgCross(n, otgSub(b, a)), otgSub(p, a)) >= 0;
    nearest = std::min(nearest, pointToSegment(p, a, b));
  }
  return above ? std::abs(otgDot(n, otgSub(p, t[0]))) / norm(n) : nearest;
}

double segmentToSegment(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  // Minimum of a convex function of one parameter: the distance of the point at s to the other segment.
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double s = low + (high - low) / 3, t = high - (high - low) / 3;
    const auto at = [&](double x) { return pointToSegment(otgAdd(a, otgScale(otgSub(b, a), x)), c, d); };
    if (at(s) < at(t))
      high = t;
    else
      low = s;
  }
  return pointToSegment(otgAdd(a, otgScale(otgSub(b, a), 0.5 * (low + high))), c, d);
}

/// Of triangles that do not intersect.
double triangleToTriangle(const Corners& s, const Corners& t) {
  double nearest = kInfinity;
  for (std::size_t i = 0; i < 3; ++i) {
    nearest = std::min({nearest, pointToTriangle(s[i], t), pointToTriangle(t[i], s)});
    for (std::size_t k = 0; k < 3; ++k) {
      nearest = std::min(nearest, segmentToSegment(s[i], s[(i + 1) % 3], t[k], t[(k + 1) % 3]));
    }
  }
  return nearest;
}

/// Solid angle over 4 pi: 1 inside, 0 outside. A. van Oosterom and J. Strackee, 1983.
double windingNumber(const std::vector<Corners>& mesh, const Vec3d& p) {
  double sum = 0;
  for (const Corners& t : mesh) {
    const Vec3d a = otgSub(t[0], p), b = otgSub(t[1], p), c = otgSub(t[2], p);
    const double la = norm(a), lb = norm(b), lc = norm(c);
    sum += 2 * std::atan2(otgDot(a, otgCross(b, c)),
                          la * lb * lc + otgDot(a, b) * lc + otgDot(b, c) * la + otgDot(c, a) * lb);
  }
  return sum / (4 * M_PI);
}

/// Distances along a ray at which it goes through a triangle's inside.
std::vector<double> rayThrough(const std::vector<Corners>& mesh, const Vec3d& origin, const Vec3d& direction) {
  std::vector<double> out;
  for (const Corners& t : mesh) {
    // Signed volumes of the ray's line with the three edges.
    double v[3];
    for (std::size_t k = 0; k < 3; ++k) {
      v[k] = otgDot(direction, otgCross(otgSub(t[k], origin), otgSub(t[(k + 1) % 3], origin)));
    }
    if (!((v[0] > 0 && v[1] > 0 && v[2] > 0) || (v[0] < 0 && v[1] < 0 && v[2] < 0))) continue;
    const Vec3d n = otgCross(otgSub(t[1], t[0]), otgSub(t[2], t[0]));
    const double at = otgDot(n, otgSub(t[0], origin)) / otgDot(n, direction);
    if (at >= 0) out.push_back(at);
  }
  std::sort(out.begin(), out.end());
  return out;
}

struct Case {
  const char* name;
  scenes::MeshArrays mesh;
};

std::vector<Case> cases() {
  const auto hills = [](double x, double y) { return 0.2 * std::sin(2 * x) * std::cos(3 * y); };
  return {{"box", scenes::makeBox({1, 0.7, 0.4}, 2)},
          {"lump", scenes::makeLump(0.6, 3, 0.3, 5)},
          {"torus", scenes::makeTorus(0.5, 0.2, 20, 12)},
          {"gear", scenes::makeGear(9, 0.6, 0.15, 0.2, 0.2)},
          {"ground", scenes::makeGround(2, 0.3, 9, hills)}};
}

}  // namespace

TEST_CASE("nearest points and signed distances are those of all triangles tried one by one") {
  const OdeSession session;
  std::mt19937 random(3);
  Draw draw(4);
  for (const Case& c : cases()) {
    const Data data(c.mesh);
    const Geom geom(data);
    setRandomPose(geom.id, random, 2);
    const std::vector<Corners> mesh = trianglesOf(geom.id);
    const Vec3d middle = toVec(dGeomGetPosition(geom.id));
    int insideCount = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3d p = otgAdd(middle, draw.inBox(i % 3 == 0 ? 3 : 0.5));
      const dVector3 point{p.x, p.y, p.z, 0};
      dGpuTriMeshClosestPoint found;
      REQUIRE(dGeomGpuTriMeshClosestPoint(geom.id, point, &found) == dGPUTRIMESH_OK);
      double nearest = kInfinity;
      for (const Corners& t : mesh) nearest = std::min(nearest, pointToTriangle(p, t));
      INFO(c.name << " point " << i);
      REQUIRE(std::abs(std::abs(found.distance) - nearest) < 1e-12);
      const bool inside = windingNumber(mesh, p) > 0.5;
      insideCount += inside ? 1 : 0;
      REQUIRE((found.distance < 0) == inside);
      // The point is on the triangle that is named, and as far as it is said to be.
      REQUIRE(pointToTriangle(toVec(found.pos), mesh[static_cast<std::size_t>(found.triangle)]) < 1e-12);
      REQUIRE(std::abs(norm(otgSub(toVec(found.pos), p)) - nearest) < 1e-12);
      REQUIRE(std::abs(norm(toVec(found.normal)) - 1) < 1e-12);
      REQUIRE(otgDot(toVec(found.normal), otgSub(p, toVec(found.pos))) * found.distance >= -1e-12);
      unsigned char flag = 2;
      REQUIRE(dGeomGpuTriMeshPointsInside(geom.id, point, sizeof point, 1, &flag) == (inside ? 1 : 0));
      REQUIRE(flag == (inside ? 1 : 0));
    }
    CHECK(insideCount > 5);
  }
}

TEST_CASE("a point behind a sheet has a negative distance, one beyond its rim does not") {
  const OdeSession session;
  scenes::MeshArrays sheet;
  for (int y = 0; y <= 4; ++y) {
    for (int x = 0; x <= 4; ++x) sheet.vertices.push_back({float(x) - 2, float(y) - 2, 0});
  }
  for (std::uint32_t y = 0; y < 4; ++y) {
    for (std::uint32_t x = 0; x < 4; ++x) {
      const std::uint32_t v = 5 * y + x;
      sheet.triangles.push_back({{v, v + 1, v + 6}});
      sheet.triangles.push_back({{v, v + 6, v + 5}});
    }
  }
  const Data data(sheet);
  const Geom geom(data);
  const auto distance = [&](double x, double y, double z) {
    const dVector3 p{x, y, z, 0};
    dGpuTriMeshClosestPoint found;
    CHECK(dGeomGpuTriMeshClosestPoint(geom.id, p, &found) == dGPUTRIMESH_OK);
    return found.distance;
  };
  CHECK(distance(0.3, 0.2, 0.5) == Approx(0.5));
  CHECK(distance(0.3, 0.2, -0.5) == Approx(-0.5));
  CHECK(distance(1, 1, -0.5) == Approx(-0.5));  // below a vertex
  CHECK(distance(3, 0, -0.1) > 0);
}

TEST_CASE("arrays of points give what single calls give, whatever the number of threads") {
  const OdeSession session;
  const Data data(scenes::makeLump(0.6, 4, 0.3, 5));
  const Geom geom(data);
  Draw draw(7);
  constexpr int kCount = 1000;
  struct Particle {
    dReal x[3], mass;
    int id;
  };
  std::vector<Particle> particles(kCount);
  for (Particle& p : particles) {
    const Vec3d x = draw.inBox(1);
    p = {{x.x, x.y, x.z}, 1, 0};
  }
  std::vector<dGpuTriMeshClosestPoint> all(kCount), again(kCount);
  REQUIRE(dGeomGpuTriMeshClosestPoints(geom.id, particles[0].x, sizeof(Particle), kCount, all.data()) == 0);
  const int threads = dGpuTriMeshGetThreadCount();
  dGpuTriMeshSetThreadCount(4);
  REQUIRE(dGeomGpuTriMeshClosestPoints(geom.id, particles[0].x, sizeof(Particle), kCount, again.data()) == 0);
  dGpuTriMeshSetThreadCount(threads);
  std::vector<unsigned char> inside(kCount);
  int negative = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    REQUIRE(std::memcmp(&all[i], &again[i], sizeof all[i]) == 0);
    dVector3 p{particles[i].x[0], particles[i].x[1], particles[i].x[2], 0};
    dGpuTriMeshClosestPoint one;
    REQUIRE(dGeomGpuTriMeshClosestPoint(geom.id, p, &one) == 0);
    REQUIRE(std::memcmp(&all[i], &one, sizeof one) == 0);
    negative += one.distance < 0 ? 1 : 0;
  }
  CHECK(dGeomGpuTriMeshPointsInside(geom.id, particles[0].x, sizeof(Particle), kCount, inside.data()) == negative);
  CHECK(negative > 50);
}

TEST_CASE("distances of meshes that are apart, and their points, are those of all pairs of triangles") {
  const OdeSession session;
  std::mt19937 random(5);
  const Data lumpData(scenes::makeLump(0.5, 1, 0.3, 3)), torusData(scenes::makeTorus(0.5, 0.2, 10, 6)),
      boxData(scenes::makeBox({1, 0.7, 0.4}, 1));
  const Geom lump(lumpData), torus(torusData), box(boxData);
  const dGpuTriMeshPair pairs[] = {{lump.id, torus.id}, {torus.id, box.id}, {box.id, lump.id}};
  int apart = 0, touching = 0;
  for (int i = 0; i < 12; ++i) {
    for (const dGeomID g : {lump.id, torus.id, box.id}) setRandomPose(g, random, 1.2);
    dGpuTriMeshDistance all[3];
    unsigned char overlaps[3];
    REQUIRE(dGpuTriMeshGetDistances(pairs, 3, dInfinity, all) == 0);
    const int overlapping = dGpuTriMeshOverlaps(pairs, 3, overlaps);
    REQUIRE(overlapping == overlaps[0] + overlaps[1] + overlaps[2]);
    for (int k = 0; k < 3; ++k) {
      const dGpuTriMeshDistance& d = all[k];
      REQUIRE((overlaps[k] != 0) == (dGpuTriMeshOverlap(pairs[k].o2, pairs[k].o1) == 1));
      REQUIRE((d.distance == 0) == (overlaps[k] != 0));
      REQUIRE((overlaps[k] != 0) == !test::collide(pairs[k].o1, pairs[k].o2).empty());
      const std::vector<Corners> m1 = trianglesOf(pairs[k].o1), m2 = trianglesOf(pairs[k].o2);
      if (d.distance == 0) {
        ++touching;
        CHECK(norm(otgSub(toVec(d.pos1), toVec(d.pos2))) < 1e-12);
        if (d.triangle1 >= 0) {
          CHECK(pointToTriangle(toVec(d.pos1), m1[static_cast<std::size_t>(d.triangle1)]) < 1e-12);
        }
        continue;
      }
      ++apart;
      double nearest = kInfinity;
      for (const Corners& s : m1) {
        for (const Corners& t : m2) nearest = std::min(nearest, triangleToTriangle(s, t));
      }
      REQUIRE(std::abs(d.distance - nearest) < 1e-9);
      REQUIRE(std::abs(norm(otgSub(toVec(d.pos1), toVec(d.pos2))) - d.distance) < 1e-12);
      REQUIRE(pointToTriangle(toVec(d.pos1), m1[static_cast<std::size_t>(d.triangle1)]) < 1e-12);
      REQUIRE(pointToTriangle(toVec(d.pos2), m2[static_cast<std::size_t>(d.triangle2)]) < 1e-12);
      dGpuTriMeshDistance limited;
      REQUIRE(dGpuTriMeshGetDistance(pairs[k].o1, pairs[k].o2, 0.9 * d.distance, &limited) == 0);
      CHECK(limited.distance == dInfinity);
      REQUIRE(dGpuTriMeshGetDistance(pairs[k].o1, pairs[k].o2, 1.1 * d.distance, &limited) == 0);
      CHECK(limited.distance == d.distance);
    }
  }
  CHECK(apart > 10);
  CHECK(touching > 3);
}

TEST_CASE("a mesh inside another one overlaps it without any contact of triangles") {
  const OdeSession session;
  const Data bigData(scenes::makeSphere(2, 3)), smallData(scenes::makeBox({0.2, 0.2, 0.2}));
  const Geom big(bigData), small(smallData);
  dGeomSetPosition(small.id, 0.5, 0.4, 0.3);
  CHECK(dGpuTriMeshOverlap(big.id, small.id) == 1);
  CHECK(dGpuTriMeshOverlap(small.id, big.id) == 1);
  dGpuTriMeshDistance d;
  REQUIRE(dGpuTriMeshGetDistance(big.id, small.id, dInfinity, &d) == 0);
  CHECK(d.distance == 0);
  CHECK(d.triangle1 == -1);
  dGeomSetPosition(small.id, 3, 0, 0);
  CHECK(dGpuTriMeshOverlap(big.id, small.id) == 0);
}

TEST_CASE("rays hit what all triangles tried one by one say, closest first, with a normal towards their start") {
  const OdeSession session;
  std::mt19937 random(9);
  Draw draw(10);
  const dGeomID ray = dCreateRay(nullptr, 4);
  for (const Case& c : cases()) {
    const Data data(c.mesh);
    const Geom geom(data);
    setRandomPose(geom.id, random, 2);
    const std::vector<Corners> mesh = trianglesOf(geom.id);
    const Vec3d middle = toVec(dGeomGetPosition(geom.id));
    int several = 0;
    for (int i = 0; i < 200; ++i) {
      const Vec3d origin = otgAdd(middle, draw.inBox(i % 4 == 0 ? 0.3 : 2));
      const Vec3d target = otgAdd(middle, draw.inBox(0.5));
      Vec3d direction = otgSub(target, origin);
      direction = otgScale(direction, 1 / norm(direction));
      dGeomRaySet(ray, origin.x, origin.y, origin.z, direction.x, direction.y, direction.z);
      std::vector<double> expected = rayThrough(mesh, origin, direction);
      std::erase_if(expected, [](double x) { return x > 4; });
      dGeomRaySetClosestHit(ray, 0);
      dGeomRaySetFirstContact(ray, 0);
      dGeomRaySetBackfaceCull(ray, 0);
      const auto hits = test::collide(ray, geom.id);
      INFO(c.name << " ray " << i);
      REQUIRE(hits.size() == expected.size());
      several += hits.size() > 1 ? 1 : 0;
      std::size_t front = 0;
      for (std::size_t k = 0; k < hits.size(); ++k) {
        const dContactGeom& h = hits[k];
        REQUIRE(std::abs(h.depth - expected[k]) < 1e-9);
        REQUIRE(h.g1 == ray);
        REQUIRE(h.g2 == geom.id);
        REQUIRE(h.side1 == -1);
        REQUIRE(otgDot(toVec(h.normal), direction) < 0);
        REQUIRE(norm(otgSub(toVec(h.pos), otgAdd(origin, otgScale(direction, h.depth)))) < 1e-9);
        const Corners& t = mesh[static_cast<std::size_t>(h.side2)];
        REQUIRE(pointToTriangle(toVec(h.pos), t) < 1e-9);
        front += otgDot(otgCross(otgSub(t[1], t[0]), otgSub(t[2], t[0])), direction) < 0 ? 1 : 0;
      }
      REQUIRE(sameContacts(test::collide(geom.id, ray), mirrored(hits)));
      if (hits.size() > 1) {  // too few places: the closest ones
        const auto two = test::collide(ray, geom.id, 1);
        REQUIRE(two.size() == 1);
        REQUIRE(sameContact(two[0], hits[0]));
      }
      dGeomRaySetBackfaceCull(ray, 1);
      REQUIRE(test::collide(ray, geom.id).size() == front);
      dGeomRaySetBackfaceCull(ray, 0);
      dGeomRaySetClosestHit(ray, 1);
      const auto closest = test::collide(ray, geom.id);
      REQUIRE(closest.size() == std::min<std::size_t>(hits.size(), 1));
      if (!hits.empty()) REQUIRE(closest[0].depth == hits[0].depth);
      dGeomRaySetClosestHit(ray, 0);
      dGeomRaySetFirstContact(ray, 1);
      REQUIRE(test::collide(ray, geom.id).size() == std::min<std::size_t>(hits.size(), 1));
      // The same ray through the arrays.
      const dGpuTriMeshRay plain{
          {origin.x, origin.y, origin.z, 0}, {3 * direction.x, 3 * direction.y, 3 * direction.z, 0}, 4};
      dGpuTriMeshRayHit hit;
      REQUIRE(dGeomGpuTriMeshCastRays(geom.id, &plain, 1, 0, &hit) == (hits.empty() ? 0 : 1));
      if (hits.empty()) {
        REQUIRE(hit.triangle == -1);
        REQUIRE(hit.distance == dInfinity);
      } else {
        REQUIRE(hit.triangle == hits[0].side2);
        REQUIRE(std::abs(hit.distance - hits[0].depth) < 1e-12);
        REQUIRE(norm(otgSub(toVec(hit.normal), toVec(hits[0].normal))) < 1e-12);
      }
    }
    CHECK(several > 20);
  }
  dGeomDestroy(ray);
}

TEST_CASE("arrays of rays with each flag hit what all triangles tried one by one say, whatever the number of threads") {
  const OdeSession session;
  std::mt19937 random(12);
  Draw draw(13);
  constexpr int kRays = 300;
  for (const Case& c : cases()) {
    const Data data(c.mesh);
    const Geom geom(data);
    setRandomPose(geom.id, random, 2);
    const std::vector<Corners> mesh = trianglesOf(geom.id);
    const Vec3d middle = toVec(dGeomGetPosition(geom.id));
    std::vector<dGpuTriMeshRay> rays(kRays);
    for (int i = 0; i < kRays; ++i) {
      const Vec3d origin = otgAdd(middle, draw.inBox(i % 3 == 0 ? 0.3 : 2)), way = draw.direction();
      const Vec3d towards = otgSub(otgAdd(middle, draw.inBox(0.5)), origin);
      const Vec3d d = i % 2 == 0 ? way : towards;
      rays[static_cast<std::size_t>(i)] = {
          {origin.x, origin.y, origin.z, 0}, {d.x, d.y, d.z, 0}, i % 5 == 0 ? dInfinity : 1.5};
    }
    std::size_t culled = 0;
    for (const int flags :
         {0, dGPUTRIMESH_RAY_CULL_BACK + 0, dGPUTRIMESH_RAY_ANY + 0, dGPUTRIMESH_RAY_CULL_BACK | dGPUTRIMESH_RAY_ANY}) {
      std::vector<dGpuTriMeshRayHit> hits(kRays), again(kRays);
      dGpuTriMeshSetThreadCount(1);
      const int found = dGeomGpuTriMeshCastRays(geom.id, rays.data(), kRays, flags, hits.data());
      dGpuTriMeshSetThreadCount(3);
      REQUIRE(dGeomGpuTriMeshCastRays(geom.id, rays.data(), kRays, flags, again.data()) == found);
      dGpuTriMeshSetThreadCount(0);
      int expectedHits = 0;
      for (std::size_t i = 0; i < kRays; ++i) {
        INFO(c.name << " ray " << i << " flags " << flags);
        REQUIRE(std::memcmp(&hits[i], &again[i], sizeof hits[i]) == 0);
        const Vec3d origin = toVec(rays[i].start);
        const Vec3d d = otgScale(toVec(rays[i].direction), 1 / norm(toVec(rays[i].direction)));
        std::vector<Corners> met = mesh;
        if ((flags & dGPUTRIMESH_RAY_CULL_BACK) != 0) {
          culled += std::erase_if(
              met, [&](const Corners& t) { return otgDot(otgCross(otgSub(t[1], t[0]), otgSub(t[2], t[0])), d) >= 0; });
        }
        std::vector<double> expected = rayThrough(met, origin, d);
        std::erase_if(expected, [&](double x) { return x > rays[i].length; });
        if (expected.empty()) {
          REQUIRE(hits[i].triangle == -1);
          continue;
        }
        ++expectedHits;
        REQUIRE(hits[i].triangle >= 0);
        const bool any = (flags & dGPUTRIMESH_RAY_ANY) != 0;
        const bool isThere = std::any_of(expected.begin(), any ? expected.end() : expected.begin() + 1,
                                         [&](double x) { return std::abs(x - hits[i].distance) < 1e-9; });
        REQUIRE(isThere);
        const Corners& t = mesh[static_cast<std::size_t>(hits[i].triangle)];
        REQUIRE(pointToTriangle(toVec(hits[i].pos), t) < 1e-9);
        REQUIRE((otgDot(otgCross(otgSub(t[1], t[0]), otgSub(t[2], t[0])), d) > 0) == (hits[i].back != 0));
        REQUIRE(otgDot(toVec(hits[i].normal), d) < 0);
      }
      REQUIRE(found == expectedHits);
      REQUIRE(expectedHits > 20);
    }
    CHECK(culled > 0);
  }
}

TEST_CASE("a ray through edges and corners of a surface hits it once") {
  const OdeSession session;
  const Data data(scenes::makeBox({2, 2, 2}, 4));
  const Geom geom(data);
  const dGeomID ray = dCreateRay(nullptr, 10);
  dGeomRaySetClosestHit(ray, 0);
  for (const double x : {0.0, 0.5, 0.25, 0.37}) {  // a corner, a corner, edges, a face's inside
    for (const double y : {0.0, 0.25, 0.11}) {
      dGeomRaySet(ray, x, y, 5, 0, 0, -1);
      const auto hits = test::collide(ray, geom.id);
      REQUIRE(hits.size() == 2);
      CHECK(hits[0].depth == Approx(4));
      CHECK(hits[1].depth == Approx(6));
    }
  }
  dGeomDestroy(ray);
}

TEST_CASE("bad arguments of queries are errors that write nothing") {
  const OdeSession session;
  const Data data(scenes::makeBox({1, 1, 1}));
  const Geom geom(data);
  const dGeomID sphere = dCreateSphere(nullptr, 1), empty = dCreateGpuTriMesh(nullptr, nullptr);
  const dVector3 point{0, 0, 0, 0}, bad{0, std::nan(""), 0, 0};
  dGpuTriMeshClosestPoint closest{};
  dGpuTriMeshDistance distance{};
  dGpuTriMeshRayHit hit{};
  unsigned char flag = 7;
  CHECK(dGeomGpuTriMeshClosestPoint(sphere, point, &closest) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGeomGpuTriMeshClosestPoint(geom.id, nullptr, &closest) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshClosestPoint(geom.id, bad, &closest) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshClosestPoint(geom.id, point, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshClosestPoints(geom.id, point, 8, 1, &closest) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshClosestPoints(geom.id, point, 24, -1, &closest) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshClosestPoints(geom.id, nullptr, 24, 0, nullptr) == dGPUTRIMESH_OK);
  CHECK(closest.triangle == 0);
  CHECK(dGeomGpuTriMeshPointsInside(geom.id, bad, 24, 1, &flag) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(flag == 7);
  CHECK(dGpuTriMeshGetDistance(geom.id, sphere, dInfinity, &distance) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGpuTriMeshGetDistance(geom.id, empty, -1, &distance) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshOverlap(sphere, geom.id) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGpuTriMeshOverlaps(nullptr, 1, &flag) == dGPUTRIMESH_ERROR_ARGUMENT);
  dGpuTriMeshRay ray{{0, 0, 5, 0}, {0, 0, 0, 0}, 10};
  CHECK(dGeomGpuTriMeshCastRays(geom.id, &ray, 1, 0, &hit) == dGPUTRIMESH_ERROR_ARGUMENT);
  ray.direction[2] = -1;
  CHECK(dGeomGpuTriMeshCastRays(geom.id, &ray, 1, 64, &hit) == dGPUTRIMESH_ERROR_ARGUMENT);
  ray.length = -1;
  CHECK(dGeomGpuTriMeshCastRays(geom.id, &ray, 1, 0, &hit) == dGPUTRIMESH_ERROR_ARGUMENT);
  ray.length = dInfinity;
  CHECK(dGeomGpuTriMeshCastRays(geom.id, &ray, 1, dGPUTRIMESH_RAY_ANY | dGPUTRIMESH_RAY_CULL_BACK, &hit) == 1);
  CHECK(hit.distance == Approx(4.5));
  // No surface: nothing near, nothing hit, no error.
  CHECK(dGeomGpuTriMeshClosestPoint(empty, point, &closest) == dGPUTRIMESH_OK);
  CHECK(closest.triangle == -1);
  CHECK(closest.distance == dInfinity);
  CHECK(dGeomGpuTriMeshCastRays(empty, &ray, 1, 0, &hit) == 0);
  CHECK(dGpuTriMeshOverlap(geom.id, empty) == 0);
  CHECK(dGpuTriMeshGetDistance(geom.id, empty, dInfinity, &distance) == dGPUTRIMESH_OK);
  CHECK(distance.distance == dInfinity);
  dGeomDestroy(sphere);
  dGeomDestroy(empty);
}

TEST_CASE("the callback for rays decides where a ray passes, and gets the place in the triangle") {
  const OdeSession session;
  const Data data(scenes::makeBox({2, 2, 2}, 2));
  const Geom geom(data);
  const dGeomID ray = dCreateRay(nullptr, 10);
  dGeomRaySetClosestHit(ray, 1);
  dGeomRaySet(ray, 0.31, 0.17, 5, 0, 0, -1);
  static int first;
  static double distance;
  REQUIRE(test::collide(ray, geom.id).size() == 1);
  first = test::collide(ray, geom.id)[0].side2;
  dGeomGpuTriMeshSetRayCallback(geom.id, [](dGeomID mesh, dGeomID, int triangle, dReal u, dReal v) {
    dVector3 place;
    CHECK(dGeomGpuTriMeshGetPoint(mesh, triangle, u, v, place) == dGPUTRIMESH_OK);
    distance = std::hypot(place[0] - 0.31, place[1] - 0.17);
    CHECK(distance < 1e-9);
    return triangle == first ? 0 : 1;
  });
  const auto behind = test::collide(ray, geom.id);
  REQUIRE(behind.size() == 1);
  CHECK(behind[0].depth == Approx(6));
  dGeomRaySetClosestHit(ray, 0);
  CHECK(test::collide(ray, geom.id).size() == 1);
  dGeomDestroy(ray);
}
