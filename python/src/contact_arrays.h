// SPDX-License-Identifier: BSD-3-Clause
// Contacts as columns: what the package's class Contacts is made of.
#pragma once

#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <tuple>
#include <vector>

#include "arrays.h"

namespace otg::python {

/// In the order of the fields of the package's Contacts: positions, normals, depths, triangles, ids, regions,
/// coherence, features, feature sides, vertices, flags.
using ContactTuple = std::tuple<Rows<double, 3>, Rows<double, 3>, Column<double>, Rows<std::int32_t, 2>,
                                Column<std::uint64_t>, Column<std::int32_t>, Column<double>, Column<std::int32_t>,
                                Column<std::int32_t>, Rows<std::int32_t, 2>, Column<std::int32_t>>;

class ContactColumns {
 public:
  void add(const dContactGeom& contact, const dGpuTriMeshContactData& data) {
    positions_.insert(positions_.end(), contact.pos, contact.pos + 3);
    normals_.insert(normals_.end(), contact.normal, contact.normal + 3);
    depths_.push_back(contact.depth);
    triangles_.insert(triangles_.end(), {data.triangle1, data.triangle2});
    ids_.push_back(data.id);
    regions_.push_back(data.region);
    coherence_.push_back(data.coherence);
    features_.push_back(data.feature);
    sides_.push_back(data.feature_side);
    vertices_.insert(vertices_.end(), {data.vertex1, data.vertex2});
    flags_.push_back(data.flags);
  }
  /// Empties the columns. The interpreter's lock has to be held.
  ContactTuple give() {
    return {giveRows<3>(std::move(positions_)), giveRows<3>(std::move(normals_)), giveColumn(std::move(depths_)),
            giveRows<2>(std::move(triangles_)), giveColumn(std::move(ids_)),      giveColumn(std::move(regions_)),
            giveColumn(std::move(coherence_)),  giveColumn(std::move(features_)), giveColumn(std::move(sides_)),
            giveRows<2>(std::move(vertices_)),  giveColumn(std::move(flags_))};
  }

 private:
  std::vector<double> positions_, normals_, depths_, coherence_;
  std::vector<std::int32_t> triangles_, regions_, features_, sides_, vertices_, flags_;
  std::vector<std::uint64_t> ids_;
};

}  // namespace otg::python
