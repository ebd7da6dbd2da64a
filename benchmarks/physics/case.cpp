// SPDX-License-Identifier: BSD-3-Clause
// Names of runs, and which models the library has.
#include "physics/case.h"

#include <fmt/format.h>
#include <ode/ode.h>

#include <array>

#include "ode_trimesh_gpu/ode_trimesh_gpu.h"

namespace otg::physics {

const char* nameOf(Form form) {
  constexpr std::array kNames{"native", "stock", "ours"};
  return kNames[static_cast<std::size_t>(form)];
}

const char* nameOf(Model model) {
  constexpr std::array kNames{"auto", "pairwise", "solid"};
  return kNames[static_cast<std::size_t>(model)];
}

std::optional<Form> formNamed(const std::string& name) {
  for (const Form form : {Form::kNative, Form::kStock, Form::kOurs})
    if (name == nameOf(form)) return form;
  return std::nullopt;
}

std::optional<Model> modelNamed(const std::string& name) {
  for (const Model model : {Model::kAuto, Model::kPairwise, Model::kSolid})
    if (name == nameOf(model)) return model;
  return std::nullopt;
}

std::string nameOf(const Stepping& stepping) {
  return stepping.stepper == Stepper::kWorld ? "W" : fmt::format("Q{}", stepping.iterations);
}

std::string describe(const Case& run) {
  std::string text = nameOf(run.stepping);
  if (run.dt != Case{}.dt) text += fmt::format(" dt=1/{:.0f}", 1 / run.dt);
  if (run.order == Order::kSwapped) text += " swapped";
  if (run.order == Order::kReversed) text += " reversed";
  if (run.offset != 0) text += fmt::format(" at={:.0e}", run.offset);
  if (run.size != 1) text += fmt::format(" size={:g}", run.size);
  if (run.fullGravity) text += " g=9.81";
  if (run.buffer != Case{}.buffer) text += fmt::format(" n={}", run.buffer);
  if (run.randomSeed != 1) text += fmt::format(" seed={}", run.randomSeed);
  return text;
}

Case nativeOf(Case run) {
  run.form = Form::kNative;
  run.model = Model::kAuto;
  run.order = Order::kAsMade;
  run.buffer = Case{}.buffer;
  return run;
}

bool isAccepted(Model model) {
  const dGeomID geom = dCreateGpuTriMesh(nullptr, nullptr);
  if (!geom) return false;
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  params.contact_model = static_cast<int>(model);
  const bool accepted = dGeomGpuTriMeshSetParams(geom, &params) == dGPUTRIMESH_OK;
  dGeomDestroy(geom);
  return accepted;
}

}  // namespace otg::physics
