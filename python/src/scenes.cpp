// SPDX-License-Identifier: BSD-3-Clause
// Scene files, generated meshes and animations: what the harness offers.
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <atomic>
#include <optional>

#include "arrays.h"
#include "base/hash.h"
#include "errors.h"
#include "module.h"
#include "scenes/concave_meshes.h"
#include "scenes/generated_meshes.h"
#include "scenes/recording.h"
#include "scenes/simulation.h"

namespace otg::python {
namespace {

using scenes::Simulation;
using scenes::StepRecord;
using MeshTuple = std::tuple<Rows<float, 3>, Rows<std::uint32_t, 3>>;

MeshTuple giveArrays(const scenes::MeshArrays& mesh) {
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;
  for (const Vec3f& v : mesh.vertices) vertices.insert(vertices.end(), {v.x, v.y, v.z});
  for (const Triangle& t : mesh.triangles) triangles.insert(triangles.end(), t.v, t.v + 3);
  return {giveRows<3>(std::move(vertices)), giveRows<3>(std::move(triangles))};
}

/// A scene that is being stepped, with the same hash as that of `otg simulate`.
class Scene {
 public:
  explicit Scene(const scenes::SceneDescription& scene) : simulation(scene) {}

  void step(double dt, int count) {
    prepareThread();
    for (int i = 0; i < count; ++i) {
      const StepRecord record = simulation.step(dt);
      add(record.contacts);
      for (std::size_t body = 0; body < simulation.bodyCount(); ++body) {
        const scenes::BodyState state = simulation.state(body);
        add(state.position);
        add(state.rotation);
        add(state.linearVelocity);
        add(state.angularVelocity);
      }
      records.push_back(record);
      energies.push_back(simulation.energy());
    }
  }
  Simulation simulation;
  std::vector<StepRecord> records;
  std::vector<scenes::Energy> energies;
  std::uint64_t hash = kFnvStart;
  std::atomic<bool> busy = false;

 private:
  template <class T>
  void add(const T& value) {
    hash = fnv1a(&value, sizeof value, hash);
  }
};

Scene* loadScene(const std::string& path, bool history) {
  prepareThread();
  scenes::SceneDescription scene = scenes::loadScene(path);
  scene.history = scene.history && history;
  return new Scene(scene);
}

Scene* parseScene(const std::string& text, const std::string& source, const std::string& folder, bool history) {
  prepareThread();
  scenes::SceneDescription scene = scenes::parseScene(text, source, folder);
  scene.history = scene.history && history;
  return new Scene(scene);
}

void stepScene(Scene& scene, double dt, int count) {
  const nb::gil_scoped_release unlocked;
  const OneAtATime alone(scene.busy);
  scene.step(dt, count);
}

/// For each step: contacts, contacts before reduction, intersecting pairs; then milliseconds of colliding and
/// stepping, kinetic and potential energy.
std::tuple<Rows<std::int64_t, 3>, Rows<double, 4>> recordsOf(const Scene& scene) {
  std::vector<std::int64_t> counts;
  std::vector<double> values;
  for (std::size_t i = 0; i < scene.records.size(); ++i) {
    const StepRecord& r = scene.records[i];
    counts.insert(counts.end(), {r.contacts, static_cast<std::int64_t>(r.contactsBeforeReduction),
                                 static_cast<std::int64_t>(r.intersectingPairs)});
    values.insert(values.end(), {r.collideMs, r.stepMs, scene.energies[i].kinetic, scene.energies[i].potential});
  }
  return {giveRows<3>(std::move(counts)), giveRows<4>(std::move(values))};
}

/// For each body: position, quaternion w x y z, linear and angular velocity, centre of mass.
std::tuple<Rows<double, 3>, Rows<double, 4>, Rows<double, 3>, Rows<double, 3>, Rows<double, 3>> statesOf(
    const Scene& scene) {
  std::vector<double> positions, rotations, linear, angular, centers;
  const auto append = [](std::vector<double>& to, const Vec3d& v) { to.insert(to.end(), {v.x, v.y, v.z}); };
  for (std::size_t i = 0; i < scene.simulation.bodyCount(); ++i) {
    const scenes::BodyState state = scene.simulation.state(i);
    append(positions, state.position);
    rotations.insert(rotations.end(), state.rotation.begin(), state.rotation.end());
    append(linear, state.linearVelocity);
    append(angular, state.angularVelocity);
    append(centers, state.centerOfMass);
  }
  return {giveRows<3>(std::move(positions)), giveRows<4>(std::move(rotations)), giveRows<3>(std::move(linear)),
          giveRows<3>(std::move(angular)), giveRows<3>(std::move(centers))};
}

/// Name, whether it stands still, colour or an empty list.
std::vector<std::tuple<std::string, bool, std::vector<double>>> bodiesOf(const Scene& scene) {
  std::vector<std::tuple<std::string, bool, std::vector<double>>> bodies;
  for (std::size_t i = 0; i < scene.simulation.bodyCount(); ++i) {
    const scenes::BodyDescription& d = scene.simulation.description(i);
    std::vector<double> color;
    if (d.color) color = {d.color->x, d.color->y, d.color->z};
    bodies.emplace_back(d.name, d.isStatic, std::move(color));
  }
  return bodies;
}

/// For each contact of the last step: position, direction, depth. As arrows are drawn, so into a body that moves.
Rows<double, 7> arrowsOf(const Scene& scene) {
  std::vector<double> rows;
  for (const scenes::ContactArrow& arrow : scenes::arrowsOf(scene.simulation)) {
    for (const Vec3d& v : {arrow.position, arrow.direction}) rows.insert(rows.end(), {v.x, v.y, v.z});
    rows.push_back(arrow.depth);
  }
  return giveRows<7>(std::move(rows));
}

std::vector<std::tuple<std::array<double, 3>, double>> planesOf(const Scene& scene) {
  std::vector<std::tuple<std::array<double, 3>, double>> planes;
  for (const scenes::PlaneDescription& p : scene.simulation.scene().planes) {
    planes.emplace_back(std::array{p.normal.x, p.normal.y, p.normal.z}, p.offset);
  }
  return planes;
}

using Size = std::array<double, 3>;

void bindGenerators(nb::module_& module) {
  const auto vec = [](const Size& size) { return Vec3d{size[0], size[1], size[2]}; };
  module.def(
      "make_box", [vec](const Size& size, int n) { return giveArrays(scenes::makeBox(vec(size), n)); }, nb::arg("size"),
      nb::arg("divisions"));
  module.def(
      "make_sphere", [](double radius, int level) { return giveArrays(scenes::makeSphere(radius, level)); },
      nb::arg("radius"), nb::arg("level"));
  module.def(
      "make_torus",
      [](double major, double minor, int m, int n) { return giveArrays(scenes::makeTorus(major, minor, m, n)); },
      nb::arg("major_radius"), nb::arg("minor_radius"), nb::arg("major_segments"), nb::arg("minor_segments"));
  module.def(
      "make_cylinder",
      [](double radius, double height, int segments, int stacks) {
        return giveArrays(scenes::makeCylinder(radius, height, segments, stacks));
      },
      nb::arg("radius"), nb::arg("height"), nb::arg("segments"), nb::arg("stacks"));
  module.def(
      "make_capsule",
      [](double radius, double length, int segments, int rings) {
        return giveArrays(scenes::makeCapsule(radius, length, segments, rings));
      },
      nb::arg("radius"), nb::arg("length"), nb::arg("segments"), nb::arg("rings"));
  module.def(
      "make_bowl",
      [](double radius, double thickness, int segments, int rings) {
        return giveArrays(scenes::makeBowl(radius, thickness, segments, rings));
      },
      nb::arg("radius"), nb::arg("thickness"), nb::arg("segments"), nb::arg("rings"));
  module.def(
      "make_gear",
      [](int teeth, double pitch, double depth, double width, double bore) {
        return giveArrays(scenes::makeGear(teeth, pitch, depth, width, bore));
      },
      nb::arg("teeth"), nb::arg("pitch_radius"), nb::arg("tooth_depth"), nb::arg("width"), nb::arg("bore_radius"));
  module.def(
      "make_lump",
      [](double radius, int level, double amplitude, std::uint32_t seed) {
        return giveArrays(scenes::makeLump(radius, level, amplitude, seed));
      },
      nb::arg("radius"), nb::arg("level"), nb::arg("amplitude"), nb::arg("seed"));
  module.def(
      "make_bolt",
      [](double radius, double pitch, double length, int segments) {
        return giveArrays(scenes::makeBolt(radius, pitch, length, segments));
      },
      nb::arg("radius"), nb::arg("pitch"), nb::arg("length"), nb::arg("segments"));
  module.def(
      "make_nut",
      [](double radius, double pitch, double length, double clearance, int segments) {
        return giveArrays(scenes::makeNut(radius, pitch, length, clearance, segments));
      },
      nb::arg("radius"), nb::arg("pitch"), nb::arg("length"), nb::arg("clearance"), nb::arg("segments"));
  module.def(
      "make_tray", [vec](const Size& size, double wall) { return giveArrays(scenes::makeTray(vec(size), wall)); },
      nb::arg("size"), nb::arg("wall"));
}

}  // namespace

void bindScenes(nb::module_& module) {
  nb::class_<Scene>(module, "Scene", "A scene file that is being stepped. `simulate` uses it.")
      .def_static("load", &loadScene, nb::arg("path"), nb::arg("history"))
      .def_static("parse", &parseScene, nb::arg("text"), nb::arg("source"), nb::arg("folder"), nb::arg("history"))
      .def("step", &stepScene, nb::arg("dt"), nb::arg("count"))
      .def("records", &recordsOf)
      .def("states", &statesOf)
      .def("bodies", &bodiesOf)
      .def("arrows", &arrowsOf)
      .def("planes", &planesOf)
      .def(
          "surface",
          [](const Scene& scene, std::size_t body) {
            if (body >= scene.simulation.bodyCount()) throw ArgumentError("there is no body with this number");
            const auto surface = scenes::surfaceOf(scene.simulation.description(body));
            scenes::MeshArrays mesh;
            mesh.vertices.assign(surface->vertices().begin(), surface->vertices().end());
            mesh.triangles.assign(surface->triangles().begin(), surface->triangles().end());
            return giveArrays(mesh);
          },
          nb::arg("body"))
      .def_prop_ro("dt", [](const Scene& scene) { return scene.simulation.scene().dt; })
      .def_prop_ro("steps", [](const Scene& scene) { return scene.simulation.scene().steps; })
      .def_ro("hash", &Scene::hash);
  bindGenerators(module);
}

}  // namespace otg::python
