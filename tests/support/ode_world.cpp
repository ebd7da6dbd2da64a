// SPDX-License-Identifier: BSD-3-Clause
#include "support/ode_world.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "support/catch.h"

namespace otg::test {
namespace {

struct P {
  double x, y, z;
};
P operator-(const P& a, const P& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
double dot(const P& a, const P& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
P cross(const P& a, const P& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct Corners {
  P p[3];
  P unitNormal() const {
    const P n = cross(p[1] - p[0], p[2] - p[0]);
    const double length = std::sqrt(dot(n, n));
    return {n.x / length, n.y / length, n.z / length};
  }
};

bool getCorners(dGeomID g, int index, Corners& out) {
  dVector3 v[3];
  if (dGeomGpuTriMeshGetTriangle(g, index, &v[0], &v[1], &v[2]) != dGPUTRIMESH_OK) return false;
  for (int k = 0; k < 3; ++k) out.p[k] = {v[k][0], v[k][1], v[k][2]};
  return true;
}

/// How far q is outside of the triangle, measured by its plane and its edges (0 inside).
double distanceOutside(const Corners& t, const P& q) {
  const P n = t.unitNormal();
  double outside = std::abs(dot(n, q - t.p[0]));
  for (int k = 0; k < 3; ++k) {
    const P edge = t.p[(k + 1) % 3] - t.p[k];
    const P inward = cross(n, edge);
    outside = std::max(outside, -dot(inward, q - t.p[k]) / std::sqrt(dot(edge, edge)));
  }
  return outside;
}

bool isOnOneSide(const Corners& plane, const Corners& t, double tolerance) {
  const P n = plane.unitNormal();
  double least = 1e300, most = -1e300;
  for (const P& p : t.p) {
    const double d = dot(n, p - plane.p[0]);
    least = std::min(least, d);
    most = std::max(most, d);
  }
  return least >= -tolerance || most <= tolerance;
}

}  // namespace

OdeSession::OdeSession() {
  dInitODE2(0);
  dAllocateODEDataForThread(dAllocateMaskAll);
  initialized_ = dGpuTriMeshInit() == 1;
}

OdeSession::~OdeSession() {
  dGpuTriMeshClose();
  dCloseODE();
}

Data::Data(const scenes::MeshArrays& mesh) : id(dGpuTriMeshDataCreate()) {
  dGpuTriMeshDataBuildSingle(id, mesh.vertices.data(), sizeof(Vec3f), static_cast<int>(mesh.vertices.size()),
                             mesh.triangles.data(), static_cast<int>(3 * mesh.triangles.size()), sizeof(Triangle));
}

dGpuTriMeshStats statsOf(dGeomID geom) {
  dGpuTriMeshStats stats;
  dGpuTriMeshStatsInit(&stats);
  CHECK(dGeomGpuTriMeshGetStats(geom, &stats) == dGPUTRIMESH_OK);
  return stats;
}

void usePairwise(dGeomID geom) {
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  params.contact_model = dGPUTRIMESH_CONTACTS_PAIRWISE;
  dGeomGpuTriMeshSetParams(geom, &params);
}

std::vector<dContactGeom> collide(dGeomID o1, dGeomID o2, int capacity, unsigned extraFlags) {
  std::vector<dContactGeom> contacts(static_cast<std::size_t>(capacity));
  const int flags = static_cast<int>(static_cast<unsigned>(capacity) | extraFlags);
  const int n = dCollide(o1, o2, flags, contacts.data(), sizeof(dContactGeom));
  contacts.resize(static_cast<std::size_t>(std::max(n, 0)));
  return contacts;
}

std::vector<unsigned char> stateOf(const std::vector<dGeomID>& geoms) {
  std::vector<unsigned char> all;
  const auto add = [&](const dReal* values, int count) {
    const auto* begin = reinterpret_cast<const unsigned char*>(values);
    all.insert(all.end(), begin, begin + static_cast<std::size_t>(count) * sizeof(dReal));
  };
  for (const dGeomID geom : geoms) {
    const dBodyID body = dGeomGetBody(geom);
    if (body == nullptr) continue;
    add(dBodyGetPosition(body), 3);
    add(dBodyGetQuaternion(body), 4);
    add(dBodyGetLinearVel(body), 3);
    add(dBodyGetAngularVel(body), 3);
  }
  const int count = static_cast<int>(geoms.size());
  std::vector<unsigned char> history(dGpuTriMeshHistorySave(geoms.data(), count, nullptr, 0));
  dGpuTriMeshHistorySave(geoms.data(), count, history.data(), history.size());
  all.insert(all.end(), history.begin(), history.end());
  return all;
}

bool sameContact(const dContactGeom& a, const dContactGeom& b) {
  return std::equal(a.pos, a.pos + 4, b.pos) && std::equal(a.normal, a.normal + 4, b.normal) && a.depth == b.depth &&
         a.g1 == b.g1 && a.g2 == b.g2 && a.side1 == b.side1 && a.side2 == b.side2;
}

bool sameContacts(const std::vector<dContactGeom>& a, const std::vector<dContactGeom>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), sameContact);
}

dContactGeom mirrored(const dContactGeom& c) {
  dContactGeom m = c;
  for (int i = 0; i < 3; ++i) m.normal[i] = -c.normal[i];
  std::swap(m.g1, m.g2);
  std::swap(m.side1, m.side2);
  return m;
}

std::vector<dContactGeom> mirrored(const std::vector<dContactGeom>& contacts) {
  std::vector<dContactGeom> result;
  for (const dContactGeom& c : contacts) result.push_back(mirrored(c));
  return result;
}

void randomRotation(dMatrix3 r, std::mt19937& random) {
  std::normal_distribution<double> normal;
  dQuaternion q = {normal(random), normal(random), normal(random), normal(random)};
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (dReal& x : q) x /= length;
  dQtoR(q, r);
}

void setPose(dGeomID geom, const Transformd& pose) {
  dMatrix3 r{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) r[4 * row + column] = pose.r[3 * row + column];
  }
  dGeomSetRotation(geom, r);
  dGeomSetPosition(geom, pose.t.x, pose.t.y, pose.t.z);
}

void joinContact(dWorldID world, dJointGroupID joints, const dContactGeom& geom) {
  dContact contact{};
  contact.surface.mode = dContactApprox1;
  contact.surface.mu = 0.5;
  contact.geom = geom;
  dJointAttach(dJointCreateContact(world, joints, &contact), dGeomGetBody(geom.g1), dGeomGetBody(geom.g2));
}

std::vector<dContactGeom> joinContacts(dWorldID world, dJointGroupID joints, dGeomID o1, dGeomID o2, int places) {
  std::vector<dContactGeom> contacts = collide(o1, o2, places);
  for (const dContactGeom& geom : contacts) joinContact(world, joints, geom);
  return contacts;
}

void appendPositions(const std::vector<dContactGeom>& contacts, std::vector<unsigned char>& bytes) {
  for (const dContactGeom& geom : contacts) {
    const auto* begin = reinterpret_cast<const unsigned char*>(geom.pos);
    bytes.insert(bytes.end(), begin, begin + 3 * sizeof(dReal));
  }
}

void setRandomPose(dGeomID geom, std::mt19937& random, double reach) {
  dMatrix3 r;
  randomRotation(r, random);
  dGeomSetRotation(geom, r);
  std::uniform_real_distribution<double> within(-reach, reach);
  const double x = within(random), y = within(random), z = within(random);
  dGeomSetPosition(geom, x, y, z);
}

const char* contactFault(const dContactGeom& c, double tolerance) {
  Corners t1{}, t2{};
  if (!getCorners(c.g1, c.side1, t1)) return "side1 is no triangle of g1";
  if (!getCorners(c.g2, c.side2, t2)) return "side2 is no triangle of g2";
  const P q = {c.pos[0], c.pos[1], c.pos[2]};
  const P n = {c.normal[0], c.normal[1], c.normal[2]};
  if (!(std::abs(dot(n, n) - 1) < 1e-12)) return "the normal has not length 1";
  if (!(c.depth >= 0)) return "the depth is negative";
  if (c.pos[3] != 0 || c.normal[3] != 0) return "a padding element is not 0";
  if (!(distanceOutside(t1, q) <= tolerance)) return "the position is not on g1's triangle";
  if (!(distanceOutside(t2, q) <= tolerance)) return "the position is not on g2's triangle";
  Corners moved = t1;
  for (P& p : moved.p) p = {p.x + c.depth * n.x, p.y + c.depth * n.y, p.z + c.depth * n.z};
  if (!isOnOneSide(t2, moved, tolerance) && !isOnOneSide(moved, t2, tolerance)) return "the move does not separate";
  return "";
}

}  // namespace otg::test
