// SPDX-License-Identifier: BSD-3-Clause
// Helpers of the tests that go through ODE: a session, meshes as geoms, contacts as values, poses.
#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <random>
#include <vector>

#include "ode_trimesh_gpu/ode_trimesh_gpu.h"
#include "scenes/generated_meshes.h"

namespace otg::test {

/// ODE and our class from construction to destruction.
class OdeSession {
 public:
  OdeSession();
  ~OdeSession();
  OdeSession(const OdeSession&) = delete;
  OdeSession& operator=(const OdeSession&) = delete;
  bool initialized() const { return initialized_; }

 private:
  bool initialized_ = false;
};

/// Mesh data that lives as long as this object.
class Data {
 public:
  explicit Data(const scenes::MeshArrays& mesh);
  ~Data() { dGpuTriMeshDataDestroy(id); }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;
  const dGpuTriMeshDataID id;
};

/// A geom outside of any space that lives as long as this object.
class Geom {
 public:
  explicit Geom(const Data& data) : id(dCreateGpuTriMesh(nullptr, data.id)) {}
  ~Geom() { dGeomDestroy(id); }
  Geom(const Geom&) = delete;
  Geom& operator=(const Geom&) = delete;
  const dGeomID id;
};

/// Has the geom collide by pairs of triangles, whose contacts can be checked one by one.
void usePairwise(dGeomID geom);

/// What the geom has counted.
dGpuTriMeshStats statsOf(dGeomID geom);

/// dCollide into an array of its own.
std::vector<dContactGeom> collide(dGeomID o1, dGeomID o2, int capacity = 4096, unsigned extraFlags = 0);

/// Positions, rotations and velocities of the geoms' bodies, and what the geoms remember: everything that a step
/// depends on.
std::vector<unsigned char> stateOf(const std::vector<dGeomID>& geoms);

/// Equal in every byte that dContactGeom's members have, geoms included.
bool sameContact(const dContactGeom& a, const dContactGeom& b);
bool sameContacts(const std::vector<dContactGeom>& a, const std::vector<dContactGeom>& b);
/// As dCollide with its geoms exchanged would have to give it.
dContactGeom mirrored(const dContactGeom& c);
std::vector<dContactGeom> mirrored(const std::vector<dContactGeom>& contacts);

/// A random rotation (uniform) and a position within `reach` of the origin along each axis.
void setRandomPose(dGeomID geom, std::mt19937& random, double reach);
/// A random rotation matrix in ODE's layout.
void randomRotation(dMatrix3 r, std::mt19937& random);
void setPose(dGeomID geom, const Transformd& pose);

/// A joint with friction between the bodies of the contact's geoms.
void joinContact(dWorldID world, dJointGroupID joints, const dContactGeom& geom);
/// What a near callback does: dCollide with so many places, and a joint with friction for each contact. Returns these.
std::vector<dContactGeom> joinContacts(dWorldID world, dJointGroupID joints, dGeomID o1, dGeomID o2, int places);
/// Appends the bytes of the contacts' positions, to compare worlds by.
void appendPositions(const std::vector<dContactGeom>& contacts, std::vector<unsigned char>& bytes);

/// What is wrong with a pairwise contact of two mesh geoms, in words, or "". From the public getters alone: the
/// position lies on both triangles. Moving g1's triangle along the normal by the depth brings one of the triangles
/// wholly to one side of the other's plane. `tolerance` is a length.
const char* contactFault(const dContactGeom& c, double tolerance);

}  // namespace otg::test
