// SPDX-License-Identifier: BSD-3-Clause
// What the kernels of kernels/solid/ are given, as far as they have a structure. They need doubles.
#ifndef OTG_SHARED_SOLID_GIVEN_H
#define OTG_SHARED_SOLID_GIVEN_H
#include "shared/layout/elements.h"
#include "shared/layout/solid_layout.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// Regions with all that belongs to them: see OTG_ARENA_UNIT.
OTG_BYTE_ELEMENT(otg_arena_byte)
/// Parts of the candidates, or uneven regions: see OTG_SOLID_CHUNK.
OTG_TWO_WORD_ELEMENT(otg_solid_chunk)

// clang-format off

#define OTG_GIVEN_SolidUneven(X, AND)      \
  X(read, otg_mesh_unit, meshes) AND       \
  X(read, otg_batch_task, tasks) AND       \
  X(read, otg_device_mesh, places) AND     \
  X(write, otg_counter, counters) AND      \
  X(read, otg_solid_chunk, chunks) AND     \
  X(value, otg_uint, chunkRoom) AND        \
  X(alias, otg_arena_byte, arena) AND      \
  X(value, otg_uint, arenaUnits)
OTG_STRUCTURE(SolidUneven, "solidUneven")

// clang-format on

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_SOLID_GIVEN_H
