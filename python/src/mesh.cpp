// SPDX-License-Identifier: BSD-3-Clause
#include "mesh.h"

#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <ode/ode.h>

#include <algorithm>
#include <limits>

#include "errors.h"
#include "mesh_io/mesh_file.h"

namespace otg::python {
namespace {

using Triangles = InputArray<std::uint32_t, nb::shape<-1, 3>>;

int toCount(std::size_t count) {
  if (count > std::size_t(std::numeric_limits<int>::max()) / 3) throw ArgumentError("the array is too long");
  return static_cast<int>(count);
}

template <class T>
std::shared_ptr<Mesh> buildMesh(const InputArray<T, nb::shape<-1, 3>>& vertices, const Triangles& triangles,
                                bool repair) {
  const nb::gil_scoped_release unlocked;
  auto mesh = std::make_shared<Mesh>();
  mesh->build(vertices.data(), sizeof(T) == sizeof(float) ? dGPUTRIMESH_VERTEX_SINGLE : dGPUTRIMESH_VERTEX_DOUBLE,
              vertices.shape(0), triangles.data(), triangles.shape(0), repair);
  return mesh;
}

nb::typed<nb::dict, nb::str, nb::object> reportOf(const Mesh& mesh) {
  dGpuTriMeshReport r;
  dGpuTriMeshReportInit(&r);
  check(dGpuTriMeshDataGetReport(mesh.data(), &r));
  nb::dict report;
  report["valid"] = r.valid != 0;
  report["vertices"] = r.vertices;
  report["triangles"] = r.triangles;
  report["edges"] = r.edges;
  report["components"] = r.components;
  report["closed"] = r.closed != 0;
  report["manifold"] = r.manifold != 0;
  report["oriented"] = r.oriented != 0;
  report["outward"] = r.outward != 0;
  report["solid"] = r.solid != 0;
  report["degenerate_triangles"] = r.degenerate_triangles;
  report["duplicate_triangles"] = r.duplicate_triangles;
  report["boundary_edges"] = r.boundary_edges;
  report["non_manifold_edges"] = r.non_manifold_edges;
  report["non_manifold_vertices"] = r.non_manifold_vertices;
  report["inconsistent_edges"] = r.inconsistent_edges;
  report["welded_vertices"] = r.welded_vertices;
  report["dropped_degenerate"] = r.dropped_degenerate;
  report["dropped_duplicates"] = r.dropped_duplicates;
  report["flipped_triangles"] = r.flipped_triangles;
  report["volume"] = r.volume;
  report["area"] = r.area;
  return nb::borrow<nb::typed<nb::dict, nb::str, nb::object>>(report);
}

/// Kind, number of elements, the first of them, a sentence.
using Problem = std::tuple<std::string, int, std::vector<int>, std::string>;

std::vector<Problem> problemsOf(const Mesh& mesh) {
  std::vector<Problem> problems;
  for (int i = 0; i < dGpuTriMeshDataGetProblemCount(mesh.data()); ++i) {
    dGpuTriMeshProblem p;
    dGpuTriMeshProblemInit(&p);
    check(dGpuTriMeshDataGetProblem(mesh.data(), i, &p));
    problems.emplace_back(dGpuTriMeshProblemName(p.kind), p.count,
                          std::vector<int>(p.elements, p.elements + p.element_count), p.message);
  }
  return problems;
}

/// Mass, centre of mass and the inertia about the mesh's origin, for a density of 1.
std::tuple<double, Column<double>, Rows<double, 3>> massOf(const Mesh& mesh) {
  dMass mass;
  mesh.checkData(dMassSetGpuTriMeshData(&mass, 1, mesh.data()), "the mass");
  std::vector<double> center(mass.c, mass.c + 3), inertia;
  for (int row = 0; row < 3; ++row) inertia.insert(inertia.end(), mass.I + 4 * row, mass.I + 4 * row + 3);
  return {mass.mass, giveColumn(std::move(center)), giveRows<3>(std::move(inertia))};
}

/// All corners of all triangles, in the mesh's frame: what a repaired mesh consists of.
Rows<double, 3> cornersOf(const Mesh& mesh) {
  const dGeomID geom = dCreateGpuTriMesh(nullptr, mesh.data());
  if (geom == nullptr) failWithLastError();
  std::vector<double> corners;
  for (int i = 0; i < dGeomGpuTriMeshGetTriangleCount(geom); ++i) {
    dVector3 v[3];
    dGeomGpuTriMeshGetTriangle(geom, i, &v[0], &v[1], &v[2]);
    for (const dReal* p : v) corners.insert(corners.end(), p, p + 3);
  }
  dGeomDestroy(geom);
  return giveRows<3>(std::move(corners));
}

template <class T>
void updateVertices(Mesh& mesh, const InputArray<T, nb::shape<-1, 3>>& vertices) {
  const nb::gil_scoped_release unlocked;
  const int count = toCount(vertices.shape(0));
  mesh.checkData(sizeof(T) == sizeof(float)
                     ? dGpuTriMeshDataUpdateVerticesSingle(mesh.data(), vertices.data(), 0, count)
                     : dGpuTriMeshDataUpdateVerticesDouble(mesh.data(), vertices.data(), 0, count),
                 "the vertices");
}

nb::bytes cook(const Mesh& mesh) {
  std::string bytes(dGpuTriMeshDataCook(mesh.data(), nullptr, 0), '\0');
  if (bytes.empty()) failWithLastError();
  dGpuTriMeshDataCook(mesh.data(), bytes.data(), bytes.size());
  return nb::bytes(bytes.data(), bytes.size());
}

/// Vertices and triangles of a file.
std::tuple<Rows<double, 3>, Rows<std::uint32_t, 3>> readFile(const std::string& path) {
  std::vector<double> vertices;
  std::vector<std::uint32_t> triangles;
  {
    const nb::gil_scoped_release unlocked;
    const mesh_io::MeshFile file = mesh_io::loadMeshFile(path);
    for (const Vec3d& v : file.vertices) vertices.insert(vertices.end(), {v.x, v.y, v.z});
    for (const Triangle& t : file.triangles) triangles.insert(triangles.end(), t.v, t.v + 3);
  }
  return {giveRows<3>(std::move(vertices)), giveRows<3>(std::move(triangles))};
}

}  // namespace

Mesh::Mesh() : data_(dGpuTriMeshDataCreate()) {
  if (data_ == nullptr) throw std::bad_alloc();
}

Mesh::~Mesh() {
  dGpuTriMeshDataDestroy(data_);
}

void Mesh::checkData(int status, const std::string& doing) const {
  if (status >= 0) return;
  const std::string why = dGpuTriMeshDataGetErrorString(data_);
  if (why.empty()) check(status, doing);
  throw StatusError(status, why);
}

void Mesh::build(const void* vertices, int vertexType, std::size_t vertexCount, const std::uint32_t* triangles,
                 std::size_t triangleCount, bool repair) {
  dGpuTriMeshBuildParams params;
  dGpuTriMeshBuildParamsInit(&params);
  params.vertices = vertices;
  params.vertex_type = vertexType;
  params.vertex_count = toCount(vertexCount);
  params.indices = triangles;
  params.index_count = 3 * toCount(triangleCount);
  params.repair = repair ? dGPUTRIMESH_REPAIR_ALL : dGPUTRIMESH_REPAIR_NONE;
  checkData(dGpuTriMeshDataBuild(data_, &params), "the mesh");
}

void bindMesh(nb::module_& module) {
  nb::class_<Mesh>(module, "Mesh", "A mesh with its BVH. The package's `Mesh` wraps it.")
      .def(nb::init<>())
      .def_static("build", &buildMesh<float>, nb::arg("vertices"), nb::arg("faces"), nb::arg("repair"))
      .def_static("build", &buildMesh<double>, nb::arg("vertices"), nb::arg("faces"), nb::arg("repair"))
      .def("report", &reportOf)
      .def("problems", &problemsOf)
      .def("mass", &massOf)
      .def("corners", &cornersOf)
      .def("update", &updateVertices<float>, nb::arg("vertices"))
      .def("update", &updateVertices<double>, nb::arg("vertices"))
      .def("cook", &cook)
      .def(
          "uncook",
          [](Mesh& mesh, const nb::bytes& bytes) {
            mesh.checkData(dGpuTriMeshDataUncook(mesh.data(), bytes.c_str(), bytes.size()), "the cooked mesh");
          },
          nb::arg("data"));
  module.def("read_mesh_file", &readFile, nb::arg("path"),
             "Vertices and faces of a mesh file, as they are written there.");
}

}  // namespace otg::python
