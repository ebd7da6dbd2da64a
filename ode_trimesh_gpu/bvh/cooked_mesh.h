// SPDX-License-Identifier: BSD-3-Clause
// A mesh with its tree, topology and report as bytes, and back.
// The container is that of cooked_bytes.h; the sections in their order are those of visitParts() in cooked_mesh.cpp.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bvh/collision_mesh.h"

namespace otg {

inline constexpr std::uint32_t kCookedVersion = 5;

/// Throws std::bad_alloc only.
std::vector<unsigned char> cookMesh(const CollisionMesh& mesh);

struct UncookedMesh {
  std::shared_ptr<CollisionMesh> mesh;  ///< null when the bytes are refused
  std::string error;                    ///< why, in one sentence
};

/// Refuses bytes that are no cooked mesh, are of another version, or are cut off or changed. Refuses parts that do not
/// fit each other (TriMeshCheck, TreeCheck). The tree's boxes are made again. Equal bytes when cooked again. Throws
/// std::bad_alloc only.
UncookedMesh uncookMesh(std::span<const unsigned char> bytes);

/// The same from a file that is open for reading at its first byte and has `size` bytes. What cannot be read counts as
/// cut off. Read in small pieces, each of which is still in the processor's cache when it is checked and put in place.
UncookedMesh uncookFile(std::FILE* file, std::uint64_t size);

}  // namespace otg
