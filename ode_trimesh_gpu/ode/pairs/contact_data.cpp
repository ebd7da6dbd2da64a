// SPDX-License-Identifier: BSD-3-Clause
#include "ode/pairs/contact_data.h"

#include <utility>

#include "collide/contact_id.h"

namespace otg {
namespace {

struct FeatureKind {
  int kind;
  int mesh;  ///< 0 A, 1 B, -1 neither
};

FeatureKind kindOf(ContactFeature feature) {
  switch (feature) {
    case ContactFeature::kFaceA:
      return {dGPUTRIMESH_FEATURE_FACE, 0};
    case ContactFeature::kFaceB:
      return {dGPUTRIMESH_FEATURE_FACE, 1};
    case ContactFeature::kCoplanar:
      return {dGPUTRIMESH_FEATURE_COPLANAR, -1};
    case ContactFeature::kVertexA:
      return {dGPUTRIMESH_FEATURE_VERTEX, 0};
    case ContactFeature::kVertexB:
      return {dGPUTRIMESH_FEATURE_VERTEX, 1};
    case ContactFeature::kCrossingA:
      return {dGPUTRIMESH_FEATURE_CROSSING, 0};
    case ContactFeature::kCrossingB:
      return {dGPUTRIMESH_FEATURE_CROSSING, 1};
    case ContactFeature::kMiddleA:
      return {dGPUTRIMESH_FEATURE_MIDDLE, 0};
    case ContactFeature::kMiddleB:
      return {dGPUTRIMESH_FEATURE_MIDDLE, 1};
    case ContactFeature::kNone:
      break;
  }
  return {dGPUTRIMESH_FEATURE_REGION, -1};
}

/// As if B were A: for the name alone.
Contact withMeshesSwapped(Contact contact) {
  switch (contact.feature) {
    case ContactFeature::kFaceA:
      contact.feature = ContactFeature::kFaceB;
      break;
    case ContactFeature::kFaceB:
      contact.feature = ContactFeature::kFaceA;
      break;
    case ContactFeature::kVertexA:
      contact.feature = ContactFeature::kVertexB;
      break;
    case ContactFeature::kVertexB:
      contact.feature = ContactFeature::kVertexA;
      break;
    case ContactFeature::kCrossingA:
      contact.feature = ContactFeature::kCrossingB;
      break;
    case ContactFeature::kCrossingB:
      contact.feature = ContactFeature::kCrossingA;
      break;
    case ContactFeature::kMiddleA:
      contact.feature = ContactFeature::kMiddleB;
      break;
    case ContactFeature::kMiddleB:
      contact.feature = ContactFeature::kMiddleA;
      break;
    case ContactFeature::kNone:
    case ContactFeature::kCoplanar:
      break;
  }
  std::swap(contact.triangleA, contact.triangleB);
  return contact;
}

}  // namespace

dGpuTriMeshContactData contactData(const Query& query, const Contact& contact, bool first, bool isOlderA) {
  static_assert(int{dGPUTRIMESH_CONTACT_INSIDE} == int{kContactInside} &&
                int{dGPUTRIMESH_CONTACT_CONTAINED} == int{kContactContained} &&
                int{dGPUTRIMESH_CONTACT_CLAMPED} == int{kContactClamped});
  const FeatureKind feature = kindOf(contact.feature);
  dGpuTriMeshContactData data{};
  data.id = contactId(isOlderA ? contact : withMeshesSwapped(contact));
  data.region = static_cast<int>(contact.region);
  data.coherence = static_cast<dReal>(contact.coherence);
  data.triangle1 = static_cast<int>(first ? contact.triangleA : contact.triangleB);
  data.triangle2 = static_cast<int>(first ? contact.triangleB : contact.triangleA);
  data.feature = feature.kind;
  data.feature_side = feature.mesh < 0 ? 0 : (feature.mesh == 0) == first ? 1 : 2;
  data.vertex1 = data.vertex2 = -1;
  const TriMesh& mesh = (feature.mesh == 1 ? query.b : query.a)->mesh();
  if (feature.kind == dGPUTRIMESH_FEATURE_VERTEX) {
    data.vertex1 = static_cast<int>(mesh.callerVertex(contact.element));
  } else if (contact.element != kNone) {
    const Topology::Edge& edge = mesh.topology().edges[contact.element];
    data.vertex1 = static_cast<int>(mesh.callerVertex(edge.a));
    data.vertex2 = static_cast<int>(mesh.callerVertex(edge.b));
  }
  data.flags = contact.flags;
  return data;
}

}  // namespace otg
