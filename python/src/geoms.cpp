// SPDX-License-Identifier: BSD-3-Clause
#include "geoms.h"

#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "contact_arrays.h"
#include "errors.h"

namespace otg::python {
namespace {

/// How far R^T R may be from the identity, as for all geoms of the library.
constexpr double kRotationTolerance = 1e-3;

void appendVector(std::vector<double>& to, const dReal* v) {
  to.insert(to.end(), v, v + 3);
}

std::tuple<Rows<double, 3>, Rows<double, 3>, Column<double>, Column<std::int32_t>> closestPoints(const Geoms& geoms,
                                                                                                 int index,
                                                                                                 const Points& points) {
  const int count = static_cast<int>(points.shape(0));
  std::vector<double> places, normals, distances;
  std::vector<std::int32_t> triangles;
  {
    const nb::gil_scoped_release unlocked;
    std::vector<dGpuTriMeshClosestPoint> found(points.shape(0));
    check(dGeomGpuTriMeshClosestPoints(geoms.at(index), points.data(), 3 * sizeof(double), count, found.data()));
    for (const auto& f : found) {
      appendVector(places, f.pos);
      appendVector(normals, f.normal);
      distances.push_back(f.distance);
      triangles.push_back(f.triangle);
    }
  }
  return {giveRows<3>(std::move(places)), giveRows<3>(std::move(normals)), giveColumn(std::move(distances)),
          giveColumn(std::move(triangles))};
}

OutputArray<bool, nb::shape<-1>> pointsInside(const Geoms& geoms, int index, const Points& points) {
  std::vector<unsigned char> inside(points.shape(0));
  {
    const nb::gil_scoped_release unlocked;
    check(dGeomGpuTriMeshPointsInside(geoms.at(index), points.data(), 3 * sizeof(double),
                                      static_cast<int>(points.shape(0)), inside.data()));
  }
  const std::size_t count = inside.size();
  static_assert(sizeof(bool) == 1);
  return give<OutputArray<bool, nb::shape<-1>>>(std::move(inside), {count});
}

std::tuple<Rows<double, 3>, Rows<double, 3>, Column<double>, Column<std::int32_t>, OutputArray<bool, nb::shape<-1>>>
castRays(const Geoms& geoms, int index, const Points& starts, const Points& directions,
         const InputArray<double, nb::shape<-1>>& lengths, bool cullBack) {
  const std::size_t count = starts.shape(0);
  if (directions.shape(0) != count || lengths.shape(0) != count)
    throw ArgumentError("the arrays of rays differ in length");
  std::vector<double> places, normals, distances;
  std::vector<std::int32_t> triangles;
  std::vector<unsigned char> back;
  {
    const nb::gil_scoped_release unlocked;
    std::vector<dGpuTriMeshRay> rays(count);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        rays[i].start[k] = starts.data()[3 * i + k];
        rays[i].direction[k] = directions.data()[3 * i + k];
      }
      rays[i].length = lengths.data()[i];
    }
    std::vector<dGpuTriMeshRayHit> hits(count);
    check(dGeomGpuTriMeshCastRays(geoms.at(index), rays.data(), static_cast<int>(count),
                                  cullBack ? dGPUTRIMESH_RAY_CULL_BACK : 0, hits.data()));
    for (const auto& hit : hits) {
      const bool met = hit.triangle >= 0;
      const dVector3 nowhere{NAN, NAN, NAN, 0};
      appendVector(places, met ? hit.pos : nowhere);
      appendVector(normals, met ? hit.normal : nowhere);
      distances.push_back(hit.distance);
      triangles.push_back(hit.triangle);
      back.push_back(static_cast<unsigned char>(hit.back));
    }
  }
  return {giveRows<3>(std::move(places)), giveRows<3>(std::move(normals)), giveColumn(std::move(distances)),
          giveColumn(std::move(triangles)), give<OutputArray<bool, nb::shape<-1>>>(std::move(back), {count})};
}

std::tuple<Column<double>, Rows<double, 3>, Rows<double, 3>, Rows<std::int32_t, 2>> distances(const Geoms& geoms,
                                                                                              const Pairs& pairs,
                                                                                              double limit) {
  std::vector<double> lengths, first, second;
  std::vector<std::int32_t> triangles;
  {
    const nb::gil_scoped_release unlocked;
    const std::vector<dGpuTriMeshPair> asked = geoms.pairsOf(pairs);
    std::vector<dGpuTriMeshDistance> found(asked.size());
    check(dGpuTriMeshGetDistances(asked.data(), static_cast<int>(asked.size()), limit, found.data()));
    for (const auto& f : found) {
      const bool known = std::isfinite(f.distance);
      const dVector3 nowhere{NAN, NAN, NAN, 0};
      lengths.push_back(f.distance);
      appendVector(first, known ? f.pos1 : nowhere);
      appendVector(second, known ? f.pos2 : nowhere);
      triangles.insert(triangles.end(), {f.triangle1, f.triangle2});
    }
  }
  return {giveColumn(std::move(lengths)), giveRows<3>(std::move(first)), giveRows<3>(std::move(second)),
          giveRows<2>(std::move(triangles))};
}

OutputArray<bool, nb::shape<-1>> overlaps(const Geoms& geoms, const Pairs& pairs) {
  std::vector<unsigned char> found(pairs.shape(0));
  {
    const nb::gil_scoped_release unlocked;
    const std::vector<dGpuTriMeshPair> asked = geoms.pairsOf(pairs);
    check(dGpuTriMeshOverlaps(asked.data(), static_cast<int>(asked.size()), found.data()));
  }
  const std::size_t count = found.size();
  return give<OutputArray<bool, nb::shape<-1>>>(std::move(found), {count});
}

struct BatchOwner {
  dGpuTriMeshBatchID id;
  ~BatchOwner() { dGpuTriMeshBatchDestroy(id); }
};

/// Contacts of all pairs, one pair after the other, and the place of each pair's first one.
std::tuple<ContactTuple, Column<std::int32_t>> collide(const Geoms& geoms, const Pairs& pairs, int limit) {
  ContactColumns columns;
  std::vector<std::int32_t> first(pairs.shape(0) + 1);
  {
    const nb::gil_scoped_release unlocked;
    prepareThread();
    const OneAtATime alone(geoms.busy());
    const std::vector<dGpuTriMeshPair> asked = geoms.pairsOf(pairs);
    dGpuTriMeshGetError();
    const BatchOwner batch{dGpuTriMeshBatchSubmit(asked.data(), static_cast<int>(asked.size()), limit)};
    if (batch.id == nullptr) failWithLastError();
    const int count = check(dGpuTriMeshBatchWait(batch.id));
    std::vector<dContactGeom> contacts(static_cast<std::size_t>(count));
    std::vector<dGpuTriMeshContactData> data(contacts.size());
    check(dGpuTriMeshBatchCollect(batch.id, contacts.data(), sizeof(dContactGeom), data.data(),
                                  sizeof(dGpuTriMeshContactData), first.data()));
    // A single pair that could not be collided has no contacts, and leaves its reason here.
    check(dGpuTriMeshGetError());
    for (std::size_t i = 0; i < contacts.size(); ++i) columns.add(contacts[i], data[i]);
  }
  return {columns.give(), giveColumn(std::move(first))};
}

nb::bytes saveHistory(const Geoms& geoms) {
  const OneAtATime alone(geoms.busy());
  std::string bytes(dGpuTriMeshHistorySave(geoms.all().data(), geoms.size(), nullptr, 0), '\0');
  if (bytes.empty()) failWithLastError();
  dGpuTriMeshHistorySave(geoms.all().data(), geoms.size(), bytes.data(), bytes.size());
  return nb::bytes(bytes.data(), bytes.size());
}

void loadHistory(Geoms& geoms, const nb::bytes& bytes) {
  const OneAtATime alone(geoms.busy());
  check(dGpuTriMeshHistoryLoad(geoms.all().data(), geoms.size(), bytes.c_str(), bytes.size()), "the memory of pairs");
}

}  // namespace

void checkPose(const double* m) {
  double sum = 0;
  for (int i = 0; i < 16; ++i) sum += m[i];
  if (!std::isfinite(sum)) throw StatusError(dGPUTRIMESH_ERROR_POSE, "a pose must be made of finite numbers");
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1) {
    throw StatusError(dGPUTRIMESH_ERROR_POSE, "the last row of a pose must be 0 0 0 1");
  }
  double defect = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double dot = m[i] * m[j] + m[4 + i] * m[4 + j] + m[8 + i] * m[8 + j];
      defect += (dot - (i == j)) * (dot - (i == j));
    }
  }
  const double determinant =
      m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
  if (std::sqrt(defect) > kRotationTolerance || determinant < 0) {
    throw StatusError(dGPUTRIMESH_ERROR_POSE,
                      "the upper left 3x3 of a pose must be a rotation; this one scales, shears or mirrors");
  }
}

void placeGeom(dGeomID geom, const double* m) {
  const dMatrix3 r{m[0], m[1], m[2], 0, m[4], m[5], m[6], 0, m[8], m[9], m[10], 0};
  dGeomSetPosition(geom, m[3], m[7], m[11]);
  dGeomSetRotation(geom, r);
}

Geoms::Geoms(const std::vector<std::shared_ptr<Mesh>>& meshes, const dGpuTriMeshParams& params) : meshes_(meshes) {
  prepareThread();
  for (const auto& mesh : meshes_) {
    const dGeomID geom = mesh ? dCreateGpuTriMesh(nullptr, mesh->data()) : nullptr;
    if (geom != nullptr) geoms_.push_back(geom);
    const int status = geom == nullptr ? dGPUTRIMESH_ERROR_MEMORY : dGeomGpuTriMeshSetParams(geom, &params);
    if (status >= 0) continue;
    for (const dGeomID made : geoms_) dGeomDestroy(made);
    check(status, "the options");
  }
}

Geoms::~Geoms() {
  for (const dGeomID geom : geoms_) dGeomDestroy(geom);
}

void Geoms::place(const Poses& poses) {
  const OneAtATime alone(busy_);
  if (poses.shape(0) != geoms_.size()) throw ArgumentError("there must be one pose for each mesh");
  for (std::size_t i = 0; i < geoms_.size(); ++i) checkPose(poses.data() + 16 * i);
  for (std::size_t i = 0; i < geoms_.size(); ++i) placeGeom(geoms_[i], poses.data() + 16 * i);
}

dGeomID Geoms::at(int index) const {
  if (index < 0 || index >= size()) throw ArgumentError("there is no mesh with this number");
  return geoms_[static_cast<std::size_t>(index)];
}

std::vector<dGpuTriMeshPair> Geoms::pairsOf(const Pairs& pairs) const {
  std::vector<dGpuTriMeshPair> result;
  result.reserve(pairs.shape(0));
  for (std::size_t i = 0; i < pairs.shape(0); ++i) result.push_back({at(pairs(i, 0)), at(pairs(i, 1))});
  return result;
}

void bindGeoms(nb::module_& module) {
  nb::class_<Geoms>(module, "Geoms", "Placed meshes. The package's query functions use it.")
      .def(nb::init<const std::vector<std::shared_ptr<Mesh>>&, const dGpuTriMeshParams&>(), nb::arg("meshes"),
           nb::arg("params"))
      .def("place", &Geoms::place, nb::arg("poses"))
      .def("collide", &collide, nb::arg("pairs"), nb::arg("limit"))
      .def("distances", &distances, nb::arg("pairs"), nb::arg("limit"))
      .def("overlaps", &overlaps, nb::arg("pairs"))
      .def("closest_points", &closestPoints, nb::arg("index"), nb::arg("points"))
      .def("inside", &pointsInside, nb::arg("index"), nb::arg("points"))
      .def("cast_rays", &castRays, nb::arg("index"), nb::arg("starts"), nb::arg("directions"), nb::arg("lengths"),
           nb::arg("cull_back"))
      .def("save_history", &saveHistory)
      .def("load_history", &loadHistory, nb::arg("data"));
}

}  // namespace otg::python
