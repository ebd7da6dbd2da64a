// SPDX-License-Identifier: BSD-3-Clause
// Round things: what contacts between spheres say, a facetted sphere that rolls, gears that drive each other.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "physics/scene.h"

namespace otg::physics {
namespace {

Vec toVec(const Vec3f& p) {
  return {p.x, p.y, p.z};
}

/// How far the facets of a mesh inscribed in a sphere lie below it at most.
double sagitta(const scenes::MeshArrays& mesh, double radius) {
  double nearest = radius;
  for (const Triangle& t : mesh.triangles) {
    const Vec a = toVec(mesh.vertices[t.v[0]]), b = toVec(mesh.vertices[t.v[1]]), c = toVec(mesh.vertices[t.v[2]]);
    nearest = std::min(nearest, std::abs(a.dot((b - a).cross(c - a).normalized())));
  }
  return radius - nearest;
}

Scene sphereContacts() {
  Scene scene;
  scene.name = "sphere_contacts";
  scene.family = "curved";
  scene.what =
      "Two facetted spheres overlap by 0.01 to 0.5 radii in random directions: normals and depth, one query each";
  scene.run = [](const Case& run) {
    constexpr double kRadius = 1;
    const scenes::MeshArrays mesh = scenes::makeSphere(kRadius, 4);
    // Both are facetted, so that the truth lies between the overlap of the spheres and that less two sagittas.
    const double depthUnit = 2 * sagitta(mesh, kRadius);
    const ShapePointer sphere = makeShape(mesh, {{NativeGeom::Kind::kSphere, Vec(kRadius, 0, 0), Vec::Zero()}});
    std::mt19937 random(static_cast<std::uint32_t>(run.randomSeed));
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
    double normalError = 0, depthError = 0;
    Measures byOverlap;
    Result result;
    for (const double overlap : {0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5}) {
      for (int i = 0; i < 8; ++i) {
        const double x = uniform(), y = uniform(), z = uniform();
        const Vec direction = Vec(x, y, z).normalized();
        const double a = uniform(), b = uniform(), c = uniform(), d = uniform();
        Rig rig(run);
        rig.addBody(sphere, {0, 0, 0});
        rig.addBody(sphere, (2 * kRadius - overlap) * direction, Rotation(a, b, c, d).normalized());
        double deepest = 0;
        for (const Contact& contact : rig.contactsNow()) {
          deepest = std::max(deepest, contact.depth);
          // Along the line of centres in either direction: which geom comes first is up to ODE's space.
          const double error =
              std::atan2(contact.normal.cross(direction).norm(), std::abs(contact.normal.dot(direction))) * 180 /
              std::numbers::pi;
          double& worst = byOverlap[fmt::format("normal_error_{:g}", overlap)];
          worst = std::max(worst, error);
          normalError = std::max(normalError, error);
        }
        depthError = std::max(depthError, std::abs(deepest - (overlap - depthUnit / 2)) / (depthUnit / 2));
        if (run.form == Form::kNative) depthError = std::abs(deepest - overlap) / depthUnit;
        result.measures = rig.measures();
      }
    }
    result.measures.merge(byOverlap);
    result.measures["normal_error"] = normalError;
    result.measures["depth_error"] = depthError;
    return result;
  };
  scene.limits = {atMost("normal_error", 5), atMost("depth_error", 1.01)};
  scene.steppings = {kW};
  scene.axes = kAxisOrder | kAxisOffset | kAxisSize | kAxisBuffer;
  scene.seconds = 1;
  return scene;
}

Scene rollingSphere() {
  Scene scene;
  scene.name = "rolling_sphere";
  scene.family = "curved";
  scene.what = "A sphere of 5,120 facets rolls at 1 m/s for 8 s; native is ODE's mesh of it on a plane";
  scene.run = [](const Case& run) {
    constexpr double kRadius = 0.5;
    // At 1/60 s a facet lasts two steps. The sphere is soon so slow that it is chance in which it is caught: single
    // runs of ODE's own mesh end with 0 to 0.1 m/s. The mean over orientations is what can be compared.
    const int runs = run.dt > 0.01 ? 400 : 1;
    const ShapePointer ground =
        makeStaticShape(scenes::makeGround(40, 1, 20), {{NativeGeom::Kind::kPlane, Vec::Zero(), Vec::Zero()}});
    const ShapePointer sphere =
        makeShape(scenes::makeSphere(kRadius, 4), {{NativeGeom::Kind::kTriMesh, Vec::Zero(), Vec::Zero()}});
    std::mt19937 random(1);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
    Result result;
    double speed = 0, gain = 0;
    for (int i = 0; i < runs; ++i) {
      const double w = uniform(), x = uniform(), y = uniform(), z = uniform();
      Rig rig(run);
      rig.addStatic(ground, {0, 0, 0});
      rig.addBody(sphere, {-4.13, 0.071, kRadius}, i == 0 ? Rotation::Identity() : Rotation(w, x, y, z).normalized());
      rig.setVelocity(0, {1, 0, 0}, {0, 1 / kRadius, 0});
      rig.run(8);
      if (i == 0) result = resultOf(rig);
      speed += rig.velocity(0).head<2>().norm();
      gain = std::max(gain, rig.measures().at("energy_gain"));
    }
    result.measures["speed"] = speed / runs;
    result.measures["energy_gain"] = gain;
    return result;
  };
  scene.limits = {ofNative("speed", Limit::Kind::kAtLeastTimesNative, 0.95), atMost("speed", 1.001),
                  atMost("energy_gain", 0.01)};
  scene.steppings = {kW, kQ20};
  scene.seconds = 8;
  return scene;
}

Scene gearPair() {
  Scene scene;
  scene.name = "gear_pair";
  scene.family = "curved";
  scene.what =
      "A gear on a motor drives an equal one on a braked hinge for 20 s: mean speed and ripple; native is its flanks "
      "as boxes";
  scene.run = [](const Case& run) {
    constexpr double kSpeed = 2, kPitchRadius = 1;
    constexpr int kTeeth = 20;
    RigOptions options;
    options.gravity = Vec::Zero();
    options.mu = 0.1;
    Rig rig(run, options);
    const ShapePointer gear = gearShape(kTeeth, kPitchRadius, 0.2, 0.3, 0.3);
    const int driver = rig.addBody(gear, {0, 0, 0});
    // Both gears have a tooth along +x; the one on the right turns a gap towards the driver.
    const int driven = rig.addBody(gear, {2 * kPitchRadius + 0.02, 0, 0}, about(Vec::UnitZ(), 180 + 180.0 / kTeeth));
    rig.addMotor(driver, Vec::UnitZ(), kSpeed, 100);
    rig.addMotor(driven, Vec::UnitZ(), 0, 0.5);
    double sum = 0, squares = 0;
    long count = 0;
    rig.run(20, [&] {
      if (rig.time() < 1) return true;
      const double speed = -rig.angularVelocity(driven).z() / kSpeed;
      sum += speed;
      squares += speed * speed;
      ++count;
      return true;
    });
    const double mean = sum / static_cast<double>(std::max(1L, count));
    Result result = resultOf(rig);
    result.measures["mean_speed"] = mean;
    result.measures["ripple"] =
        std::sqrt(std::max(0.0, squares / static_cast<double>(std::max(1L, count)) - mean * mean));
    return result;
  };
  scene.limits = {atLeast("mean_speed", 0.99), atMost("mean_speed", 1.01), atMost("ripple", 0.3),
                  ofNative("ripple", Limit::Kind::kWithinShareOfNative, 0.05), atMost("depth_per_5ms", 0.01)};
  scene.steppings = {kW, kQ50};
  scene.seconds = 20;
  return scene;
}

}  // namespace

std::vector<Scene> curvedScenes() {
  return {sphereContacts(), rollingSphere(), gearPair()};
}

}  // namespace otg::physics
