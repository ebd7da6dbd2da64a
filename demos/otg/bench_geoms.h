// SPDX-License-Identifier: BSD-3-Clause
// Meshes of benchmarks as geoms in ODE.
#pragma once

#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <cstdint>
#include <string>

#include "mesh/tri_mesh.h"

namespace otg::cli {

/// Mesh data for geoms; the caller destroys them. Throws InputError where the library refuses the mesh.
dGpuTriMeshDataID meshData(const TriMesh& mesh, const std::string& name);

void poseGeom(dGeomID geom, const Transformd& pose);

/// Calls that devices have had so far.
std::uint64_t deviceCalls();

}  // namespace otg::cli
