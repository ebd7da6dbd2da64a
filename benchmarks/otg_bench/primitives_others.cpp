// SPDX-License-Identifier: BSD-3-Clause
// `otg bench primitives`: planes, rays, dTriMeshes and heightfields.
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <cmath>

#include "cli/progress.h"
#include "otg_bench/error_quantiles.h"
#include "otg_bench/primitives.h"
#include "scenes/height_grid.h"
#include "scenes/heightfield_geom.h"
#include "truth/contact_errors.h"

namespace otg::cli {
namespace {

using truth::Errors;
using truth::TessellatedBody;

Json planeRow(TessellatedBody subject, const PrimitivesOptions& options) {
  const MeshGeom mesh(subject.mesh);
  const NativeGeom native(subject.body, subject.mesh);
  const dGeomID plane = dCreatePlane(nullptr, 0, 0, 1, 0);
  truth::Random random(options.seed);
  Errors angle, toOde, depth, ofOde;
  PoseCounts counts;
  while (counts.poses < options.poses) {
    subject.body.pose = drawnPose(random, 2);
    const Vec3d n = random.direction();
    // How deep the body is to lie in it.
    const double overlap = random.uniform(kLeastOverlap, kMostOverlap);
    const double offset = overlap - subject.body.reach(otgScale(n, -1.0));
    dGeomPlaneSetParams(plane, n.x, n.y, n.z, offset);
    for (const dGeomID geom : {mesh.id(), native.id()}) placeGeom(geom, subject.body.pose);
    const DeepestContact ours = collideDeepest(mesh.id(), plane), theirs = collideDeepest(native.id(), plane);
    const bool isBoth = counts.add(ours.count > 0, theirs.count > 0);
    if (theirs.count > 0) ofOde.add(std::fabs(theirs.depth - overlap));
    if (ours.count == 0) continue;
    angle.add(truth::angleBetween(ours.normal, n));
    depth.add(std::fabs(ours.depth - overlap));
    if (isBoth) toOde.add(std::fabs(ours.depth - theirs.depth));
  }
  dGeomDestroy(plane);
  return makeRow({{"mesh", subject.name}}, counts,
                 {{"angle", &angle}, {"depth_to_ode", &toOde}, {"depth", &depth}, {"depth_of_ode", &ofOde}});
}

Json rayRow(const TessellatedBody& subject, const PrimitivesOptions& options) {
  const MeshGeom mesh(subject.mesh);
  const NativeGeom native(subject.body, subject.mesh);
  const dGeomID ray = dCreateRay(nullptr, 4);
  dGeomRaySetClosestHit(ray, 1);
  truth::Random random(options.seed);
  Errors angle, distance;
  PoseCounts counts;
  while (counts.poses < options.poses) {
    const Transformd pose = drawnPose(random, 0.3);
    for (const dGeomID geom : {mesh.id(), native.id()}) placeGeom(geom, pose);
    const Vec3d from = otgScale(random.direction(), 2.0);
    const Vec3d to{random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6)};
    const Vec3d along = otgSub(to, from);
    dGeomRaySet(ray, from.x, from.y, from.z, along.x, along.y, along.z);
    const DeepestContact ours = collideDeepest(mesh.id(), ray), theirs = collideDeepest(native.id(), ray);
    if (ours.count == 0 && theirs.count == 0) continue;
    if (!counts.add(ours.count > 0, theirs.count > 0)) continue;
    angle.add(truth::angleBetween(ours.normal, theirs.normal));
    distance.add(std::fabs(ours.depth - theirs.depth));
  }
  dGeomDestroy(ray);
  return makeRow({{"mesh", subject.name}}, counts, {{"angle_to_ode", &angle}, {"distance_to_ode", &distance}});
}

/// Contacts of a mesh with another geom, and with a mesh of the same triangles.
class SameGround {
 public:
  void compare(dGeomID mesh, dGeomID other, dGeomID sameAsMesh) {
    for (const dGeomID geom : {mesh, sameAsMesh}) dGeomGpuTriMeshForgetHistory(geom);
    const DeepestContact found = collideDeepest(mesh, other);
    for (const dGeomID geom : {mesh, sameAsMesh}) dGeomGpuTriMeshForgetHistory(geom);
    const DeepestContact wanted = collideDeepest(mesh, sameAsMesh);
    if (found.count == 0 && wanted.count == 0) return;
    ++poses_;
    if (found.count == 0 || wanted.count == 0) {
      ++missed_;
      return;
    }
    if (found.count != wanted.count) ++otherCounts_;
    angle_.add(truth::angleBetween(found.normal, wanted.normal));
    depth_.add(std::fabs(found.depth - wanted.depth));
    const Vec3d d = otgSub(found.position, wanted.position);
    place_.add(std::sqrt(otgDot(d, d)));
  }
  int poses() const { return poses_; }
  Json row(const std::string& mesh, const std::string& other) const {
    Json row;
    row["mesh"] = mesh;
    row["other"] = other;
    row["poses"] = poses_;
    row["missed"] = missed_;
    row["other_counts"] = otherCounts_;
    addErrorQuantiles(row, "angle", angle_);
    addErrorQuantiles(row, "depth", depth_);
    addErrorQuantiles(row, "place", place_);
    return row;
  }

 private:
  int poses_ = 0, missed_ = 0, otherCounts_ = 0;
  Errors angle_, depth_, place_;
};

Json trimeshRow(const TessellatedBody& subject, const TessellatedBody& partner, const PrimitivesOptions& options) {
  const MeshGeom mesh(subject.mesh), same(partner.mesh);
  const MeshInput input = partner.mesh.input();
  const dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(data, input.vertices, sizeof(Vec3f), static_cast<int>(input.vertexCount), input.indices,
                              static_cast<int>(3 * input.triangleCount), sizeof(Triangle));
  const dGeomID other = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
  truth::Random random(options.seed);
  SameGround errors;
  while (errors.poses() < options.poses) {
    placeGeom(mesh.id(), drawnPose(random, 0.6));
    const Transformd pose = drawnPose(random, 0.6);
    for (const dGeomID geom : {other, same.id()}) placeGeom(geom, pose);
    errors.compare(mesh.id(), other, same.id());
  }
  dGpuTriMeshOverrideForgetGeom(other);
  dGpuTriMeshOverrideForgetData(data);
  dGeomDestroy(other);
  dGeomTriMeshDataDestroy(data);
  return errors.row(subject.name, "dTriMesh of a " + partner.name);
}

Json fieldRow(const TessellatedBody& subject, const PrimitivesOptions& options) {
  scenes::HeightGrid grid;
  grid.sizeX = 6;
  grid.sizeY = 4;
  grid.columns = 25;
  grid.rows = 17;
  grid.thickness = 5;
  scenes::setRoughHeights(grid, 0.3, 1.5, options.seed);
  const MeshGeom mesh(subject.mesh), same(scenes::solidOf(grid, 6));
  const scenes::HeightfieldData data(grid);
  const dGeomID field = data.makeGeom(nullptr, Transformd{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}});
  truth::Random random(options.seed);
  SameGround errors;
  while (errors.poses() < options.poses) {
    Transformd pose = random.rotation();
    // Above a sample, and up to a tenth deep there.
    const int i = 4 + random.below(grid.columns - 8), j = 4 + random.below(grid.rows - 8);
    truth::ConvexBody turned = subject.body;
    turned.pose = pose;
    const double down = turned.reach({0, 0, -1});
    pose.t = {grid.x(i), grid.y(j), grid.at(i, j) + down - random.uniform(kLeastOverlap, kMostOverlap)};
    placeGeom(mesh.id(), pose);
    errors.compare(mesh.id(), field, same.id());
  }
  dGeomDestroy(field);
  return errors.row(subject.name, "heightfield");
}

template <class Row>
Json rowForEachMesh(const Row& row) {
  Json rows = Json::array();
  for (const TessellatedBody& subject : comparedMeshes()) rows.push_back(row(subject));
  return rows;
}

}  // namespace

Json comparePlanes(const PrimitivesOptions& options) {
  return rowForEachMesh([&](const TessellatedBody& subject) { return planeRow(subject, options); });
}

Json compareRays(const PrimitivesOptions& options) {
  return rowForEachMesh([&](const TessellatedBody& subject) { return rayRow(subject, options); });
}

Json compareOtherMeshes(const PrimitivesOptions& options) {
  Json rows = Json::array();
  const std::vector<TessellatedBody> subjects = comparedMeshes(), partners = truth::smallBodies();
  Progress parts(subjects.size() * (partners.size() + 1));
  for (const TessellatedBody& subject : subjects) {
    for (const TessellatedBody& partner : partners) {
      rows.push_back(trimeshRow(subject, partner, options));
      parts.step();
    }
    rows.push_back(fieldRow(subject, options));
    parts.step();
  }
  return rows;
}

}  // namespace otg::cli
