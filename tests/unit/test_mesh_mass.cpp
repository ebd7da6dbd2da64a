// SPDX-License-Identifier: BSD-3-Clause
// Mass properties against closed forms and against integration by other means.
#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "scenes/generated_meshes.h"
#include "support/catch.h"

using namespace otg;
using namespace otg::scenes;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

MassProperties massOf(const MeshArrays& mesh) {
  return computeMassProperties(mesh.vertices, mesh.triangles);
}

Vector3d at(const MeshArrays& mesh, std::uint32_t v) {
  return {mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z};
}

Matrix3d inertiaOfCovariance(const Matrix3d& c) {
  return c.trace() * Matrix3d::Identity() - c;
}

/// Integrals over a tetrahedron by its vertex values: a uniform tetrahedron has a covariance about its own centroid g
/// of V / 20 times the vertices' sum of (p - g)(p - g)^T.
MassProperties tetrahedron(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  MassProperties m;
  m.volume = (b - a).cross(c - a).dot(d - a) / 6;
  m.centerOfMass = (a + b + c + d) / 4;
  Matrix3d covariance = Matrix3d::Zero();
  for (const Vector3d& p : {a, b, c, d}) covariance += (p - m.centerOfMass) * (p - m.centerOfMass).transpose();
  m.inertia = inertiaOfCovariance(m.volume / 20 * covariance);
  return m;
}

/// Sums of whole tetrahedra and the parallel-axis theorem, in long steps about the origin: another way to the same
/// numbers.
MassProperties byTetrahedra(const MeshArrays& mesh) {
  MassProperties sum;
  std::vector<MassProperties> parts;
  for (const Triangle& t : mesh.triangles) {
    parts.push_back(tetrahedron(Vector3d::Zero(), at(mesh, t.v[0]), at(mesh, t.v[1]), at(mesh, t.v[2])));
    sum.volume += parts.back().volume;
    sum.centerOfMass += parts.back().volume * parts.back().centerOfMass;
    sum.area += 0.5 * (at(mesh, t.v[1]) - at(mesh, t.v[0])).cross(at(mesh, t.v[2]) - at(mesh, t.v[0])).norm();
  }
  sum.centerOfMass /= sum.volume;
  for (const MassProperties& part : parts) {
    const Vector3d r = part.centerOfMass - sum.centerOfMass;
    sum.inertia += part.inertia + part.volume * inertiaOfCovariance(r * r.transpose());
  }
  return sum;
}

void checkSame(const MassProperties& a, const MassProperties& b, double tolerance, double size = 1) {
  CHECK(a.volume == Approx(b.volume).epsilon(tolerance));
  CHECK((a.centerOfMass - b.centerOfMass).norm() <= tolerance * size);
  CHECK((a.inertia - b.inertia).norm() <= tolerance * b.inertia.norm());
}

}  // namespace

TEST_CASE("a box has the inertia of a box") {
  for (const int n : {1, 4}) {
    const MassProperties m = massOf(makeBox({2, 4, 8}, n));
    CHECK(m.volume == Approx(64).epsilon(1e-14));
    CHECK(m.area == Approx(112).epsilon(1e-14));
    CHECK(m.centerOfMass.norm() < 1e-14);
    const Matrix3d expected = Vector3d(16 + 64, 4 + 64, 4 + 16).asDiagonal();
    CHECK((m.inertia - 64.0 / 12 * expected).norm() < 1e-12 * m.inertia.norm());
  }
}

TEST_CASE("tetrahedra have the closed form of tetrahedra") {
  const Vec3d corners[][4] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                              {{0.5, -1, 2}, {3, 0.25, -1}, {-2, 4, 0}, {1, 1, 5}},
                              {{10, 10, 10}, {11, 10, 10}, {10, 10.5, 10}, {10, 10, 10.25}}};
  for (const auto& p : corners) {
    const MeshArrays mesh = makeTetrahedron(p[0], p[1], p[2], p[3]);
    MassProperties expected = tetrahedron({p[0].x, p[0].y, p[0].z}, {p[1].x, p[1].y, p[1].z}, {p[2].x, p[2].y, p[2].z},
                                          {p[3].x, p[3].y, p[3].z});
    if (expected.volume < 0) {
      expected.volume = -expected.volume;
      expected.inertia = -expected.inertia;
    }
    checkSame(massOf(mesh), expected, 1e-12);
  }
}

TEST_CASE("polyhedra agree with sums of tetrahedra") {
  for (const MeshArrays& mesh : {makeSphere(1.5, 3), makeTorus(2, 0.5, 30, 16), makeLump(1, 4, 0.4, 2),
                                 makeBowl(1, 0.2, 24, 8), makeNut(8, 2, 6, 0.1, 36)}) {
    const MassProperties m = massOf(mesh), expected = byTetrahedra(mesh);
    checkSame(m, expected, 1e-10);
    CHECK(m.area == Approx(expected.area).epsilon(1e-12));
  }
}

TEST_CASE("subdivided spheres converge to the ball with the order of the surface") {
  const double r = 2, volume = 4.0 / 3 * std::numbers::pi * r * r * r, inertia = 0.4 * volume * r * r;
  double volumeBefore = 0, inertiaBefore = 0;
  for (int level = 1; level <= 5; ++level) {
    const MassProperties m = massOf(makeSphere(r, level));
    CHECK(m.centerOfMass.norm() < 1e-6);
    // The icosahedral symmetry leaves no preferred axis.
    CHECK((m.inertia - m.inertia(0, 0) * Matrix3d::Identity()).norm() < 1e-5 * m.inertia.norm());
    const double volumeError = volume - m.volume, inertiaError = inertia - m.inertia(0, 0);
    if (level > 2) {
      CHECK(volumeBefore / volumeError == Approx(4).epsilon(0.05));
      CHECK(inertiaBefore / inertiaError == Approx(4).epsilon(0.05));
    }
    volumeBefore = volumeError;
    inertiaBefore = inertiaError;
  }
  CHECK(volumeBefore < 3e-3 * volume);
}

TEST_CASE("far from the origin nothing but the coordinates' own rounding is lost") {
  // Coordinates that float holds exactly after the shift, a thousand sizes away.
  const MeshArrays near = makeBox({2, 4, 8}, 2);
  const MeshArrays far = transformed(near, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {8192, -4096, 16384}});
  const MassProperties a = massOf(near), b = massOf(far);
  CHECK(b.volume == Approx(a.volume).epsilon(1e-14));
  CHECK((b.centerOfMass - Vector3d(8192, -4096, 16384)).norm() < 1e-11);
  CHECK((b.inertia - a.inertia).norm() < 1e-13 * a.inertia.norm());
}

TEST_CASE("rotation turns the inertia, winding changes its sign") {
  MeshArrays mesh = makeTetrahedron({0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 1});
  const MassProperties a = massOf(mesh);
  const Transformd quarter{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 0}};
  Matrix3d r;
  r << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const MassProperties b = massOf(transformed(mesh, quarter));
  CHECK((b.inertia - r * a.inertia * r.transpose()).norm() < 1e-12);
  CHECK((b.centerOfMass - r * a.centerOfMass).norm() < 1e-12);
  for (Triangle& t : mesh.triangles) std::swap(t.v[0], t.v[1]);
  const MassProperties inward = massOf(mesh);
  CHECK(inward.volume == Approx(-a.volume));
  CHECK((inward.centerOfMass - a.centerOfMass).norm() < 1e-12);
  CHECK((inward.inertia + a.inertia).norm() < 1e-12);
}

TEST_CASE("a sheet without volume balances at the middle of its area") {
  const MeshArrays sheet{{{1, 1, 5}, {3, 1, 5}, {3, 3, 5}, {1, 3, 5}}, {{{0, 1, 2}}, {{0, 2, 3}}}};
  const MassProperties m = massOf(sheet);
  CHECK(std::abs(m.volume) < 1e-12);
  CHECK(m.area == Approx(4));
  CHECK((m.centerOfMass - Vector3d(2, 2, 5)).norm() < 1e-12);
  CHECK(m.inertia.norm() < 1e-12);
}
