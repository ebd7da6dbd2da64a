// SPDX-License-Identifier: BSD-3-Clause
// Terrains, and bodies that lie on them: what tests of sheets share.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "collide/stages.h"
#include "scenes/height_grid.h"
#include "support/draw.h"
#include "support/solid_batches.h"

namespace otg::test {

using MeshPtr = std::shared_ptr<const CollisionMesh>;

/// A square terrain with its middle at the origin, of 2 cells^2 triangles that face up.
inline scenes::MeshArrays terrain(double size, int cells, double rough, std::uint32_t seed = 1) {
  scenes::HeightGrid grid;
  grid.sizeX = grid.sizeY = size;
  grid.columns = grid.rows = cells + 1;
  if (rough > 0) {
    scenes::setRoughHeights(grid, rough, 0.3 * size, seed);
  } else {
    scenes::setHeights(grid, [](double, double) { return 0.0; });
  }
  return scenes::sheetOf(grid);
}

inline scenes::MeshArrays scaled(scenes::MeshArrays mesh, Vec3d by) {
  for (Vec3f& v : mesh.vertices) {
    v = {static_cast<float>(v.x * by.x), static_cast<float>(v.y * by.y), static_cast<float>(v.z * by.z)};
  }
  return mesh;
}

inline Transformd inverse(const Transformd& t) {
  const double* r = t.r;
  Transformd out{{r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]}, {0, 0, 0}};
  out.t = otgScale(otgRotate(out, t.t), -1.0);
  return out;
}

inline Query solidQuery(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA) {
  Query query = makeQuery(a, b, bInA);
  query.options.contacts = ContactModel::kSolid;
  query.options.maxContacts = 16;
  return query;
}

inline std::vector<Contact> contactsOf(const Query& query) {
  Workspace workspace;
  collide(query, workspace);
  return workspace.reduced;
}

/// The body lowered (along z, or raised where the sheet faces down) until it is `depth` deep in the sheet.
inline Transformd loweredOn(const CollisionMesh& sheet, const CollisionMesh& body, Transformd pose, double depth,
                            double sign) {
  Workspace workspace;
  const auto size = 2 * static_cast<double>(body.mesh().radius());
  double apart = 2 * size;
  for (double step = 0.5 * size; step > 1e-6 * size;) {
    pose.t.z = sign * (apart - step);
    findIntersectingPairs(makeQuery(sheet, body, pose), workspace);
    if (workspace.intersecting.empty() && apart > -2 * size) {
      apart -= step;
    } else {
      step *= 0.5;
    }
  }
  pose.t.z = sign * (apart - depth * size);
  return pose;
}

/// Bodies at random places of a sheet, within `reach` of its middle, both ways round; `least` to `most` of their size
/// deep.
inline std::vector<Query> lying(const CollisionMesh& sheet, const MeshList& all, std::uint32_t seed, std::size_t count,
                                double reach, double least, double most, double sign = 1) {
  Draw draw(seed);
  std::vector<Query> queries;
  while (queries.size() < count) {
    const CollisionMesh& body = *all[draw.below(static_cast<std::uint32_t>(all.size()))];
    Transformd pose = makePose(draw.direction(), draw.uniform(0, 6), {0, 0, 0});
    pose.t = {draw.uniform(-reach, reach), draw.uniform(-reach, reach), 0};
    pose = loweredOn(sheet, body, pose, draw.uniform(least, most), sign);
    queries.push_back(queries.size() % 2 == 0 ? solidQuery(sheet, body, pose) : solidQuery(body, sheet, inverse(pose)));
  }
  return queries;
}

}  // namespace otg::test
