// SPDX-License-Identifier: BSD-3-Clause
// Cooked meshes under a checksum that is right, and a collision of what is accepted.
#include "bvh/cooked_mesh.h"
#include "collide/query.h"
#include "fuzz/fuzz_target.h"
#include "scenes/generated_meshes.h"
#include "support/cooked_file.h"

using namespace otg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<unsigned char> bytes(data, data + size / 8 * 8);
  if (bytes.size() >= 16) test::seal(bytes);
  const UncookedMesh uncooked = uncookMesh(bytes);
  fuzz::require((uncooked.mesh == nullptr) == !uncooked.error.empty());
  if (uncooked.mesh == nullptr) return 0;
  fuzz::require(validateTree(uncooked.mesh->tree(), uncooked.mesh->mesh()).empty());
  static const CollisionMesh box(scenes::build(scenes::makeBox({1, 1, 1})), BuildStrategy::kSah);
  for (const ContactModel model : {ContactModel::kSolid, ContactModel::kPairwise}) {
    Query query;
    query.a = uncooked.mesh.get();
    query.b = &box;
    query.bInA = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.6, 0.1, 0.2}};
    query.options.contacts = model;
    Workspace workspace;
    collide(query, workspace);
  }
  return 0;
}

std::vector<fuzz::Input> fuzz::seeds() {
  std::vector<Input> all;
  for (const scenes::MeshArrays& arrays :
       {scenes::makeBox({1, 1, 1}), scenes::makeLump(1, 1, 0.2, 3), scenes::makeGround(2, 0.5, 2)}) {
    for (const MeshOrder order : {MeshOrder::kInput, MeshOrder::kLocal}) {
      all.push_back(cookMesh(CollisionMesh(buildTriMesh(arrays.input(), {}, order).mesh, BuildStrategy::kSah)));
    }
  }
  return all;
}
