// SPDX-License-Identifier: BSD-3-Clause
// Motions, as animations and as pages.
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "errors.h"
#include "module.h"
#include "scenes/generated_meshes.h"
#include "scenes/gltf_animation.h"
#include "scenes/html_page.h"
#include "scenes/recording.h"

namespace otg::python {
namespace {

using scenes::Recording;
using Color = std::array<double, 3>;

/// One position and quaternion for each frame, or a single one.
void addBody(Recording& recording, const std::string& name, const InputArray<float, nb::shape<-1, 3>>& vertices,
             const InputArray<std::uint32_t, nb::shape<-1, 3>>& faces, const Color& color, const Points& positions,
             const InputArray<double, nb::shape<-1, 4>>& rotations) {
  const std::size_t frames = positions.shape(0);
  if ((frames != recording.times.size() && frames != 1) || rotations.shape(0) != frames) {
    throw ArgumentError("body '" + name + "' must have one position and rotation for each time, or a single one");
  }
  scenes::MeshArrays mesh;
  for (std::size_t i = 0; i < vertices.shape(0); ++i) {
    mesh.vertices.push_back({vertices(i, 0), vertices(i, 1), vertices(i, 2)});
  }
  for (std::size_t i = 0; i < faces.shape(0); ++i) {
    mesh.triangles.push_back({{faces(i, 0), faces(i, 1), faces(i, 2)}});
  }
  scenes::AnimatedBody& body = recording.bodies.emplace_back();
  body.name = name;
  body.surface = scenes::build(mesh);
  body.color = {color[0], color[1], color[2]};
  for (std::size_t i = 0; i < frames; ++i) {
    body.positions.push_back({positions(i, 0), positions(i, 1), positions(i, 2)});
    body.rotations.push_back({rotations(i, 0), rotations(i, 1), rotations(i, 2), rotations(i, 3)});
  }
}

/// Of the next frame, a row for each contact: position, direction, depth.
void addArrows(Recording& recording, const InputArray<double, nb::shape<-1, 7>>& rows) {
  if (recording.contacts.size() == recording.times.size()) throw ArgumentError("every frame has its contacts");
  std::vector<scenes::ContactArrow>& arrows = recording.contacts.emplace_back();
  for (std::size_t i = 0; i < rows.shape(0); ++i) {
    arrows.push_back({{rows(i, 0), rows(i, 1), rows(i, 2)}, {rows(i, 3), rows(i, 4), rows(i, 5)}, rows(i, 6)});
  }
}

/// A row for each step: contacts, kinetic and potential energy.
void setSteps(Recording& recording, double dt, int stepsPerFrame, const Points& rows) {
  recording.dt = dt;
  recording.stepsPerFrame = stepsPerFrame;
  for (std::size_t i = 0; i < rows.shape(0); ++i) {
    scenes::StepFigures& figures = recording.steps.emplace_back();
    figures.record.contacts = static_cast<int>(rows(i, 0));
    figures.energy = {rows(i, 1), rows(i, 2)};
  }
}

template <class Write>
void write(Recording& recording, const Write& writeFile) {
  recording.contacts.resize(recording.times.size());
  try {
    writeFile();
  } catch (const std::runtime_error& error) {
    throw StatusError(dGPUTRIMESH_ERROR_FILE, error.what());
  }
}

}  // namespace

void bindRecording(nb::module_& module) {
  nb::class_<Recording>(module, "Recording", "A motion that is written to a file. `Recording` and `Run` use it.")
      .def(
          "__init__",
          [](Recording* recording, const std::vector<double>& times) { (new (recording) Recording)->times = times; },
          nb::arg("times"))
      .def("add_body", &addBody, nb::arg("name"), nb::arg("vertices"), nb::arg("faces"), nb::arg("color"),
           nb::arg("positions"), nb::arg("rotations"))
      .def(
          "add_plane",
          [](Recording& recording, const Color& normal, double offset) {
            recording.planes.push_back({{normal[0], normal[1], normal[2]}, offset});
          },
          nb::arg("normal"), nb::arg("offset"))
      .def("add_arrows", &addArrows, nb::arg("rows"))
      .def("set_steps", &setSteps, nb::arg("dt"), nb::arg("steps_per_frame"), nb::arg("rows"))
      .def(
          "write_gltf",
          [](Recording& recording, const std::string& path) {
            write(recording, [&] { scenes::writeGlb(path, recording); });
          },
          nb::arg("path"))
      .def(
          "write_html",
          [](Recording& recording, const std::string& path, const std::string& title) {
            write(recording, [&] { scenes::writeHtmlPage(path, title, recording); });
          },
          nb::arg("path"), nb::arg("title"));
}

}  // namespace otg::python
