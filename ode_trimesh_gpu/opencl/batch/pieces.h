// SPDX-License-Identifier: BSD-3-Clause
// How a batch is cut: into submissions, these into pieces, and pieces into halves where memory runs out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bvh/collision_mesh.h"
#include "opencl/tuning.h"
#include "shared/layout/device_layout.h"

namespace otg::opencl {

/// Consecutive pairs of a batch.
struct PairRange {
  std::size_t begin = 0, count = 0;
  bool operator==(const PairRange&) const = default;
};

/// The submissions of a batch, each a list of pieces: all pieces of one are begun before the first is waited for. So
/// the CPU finishes what the device leaves of one while the device has the next. `inOnePiece`: stages are timed, and
/// each is to have the device for itself.
std::vector<std::vector<PairRange>> cutBatch(std::size_t pairs, const Tuning& tuning, bool inOnePiece);

/// Where items 0 to `work.size()` - 1 are cut so that no part has more work than `most`, but for a single item that
/// has: the end of each part. Parts follow each other.
std::vector<std::size_t> cutByWork(std::span<const double> work, double most);

/// The submissions of a batch. Pieces have no more work than Tuning::batchWork, as far as pairs can be separated, and
/// so many are under way at once: no launch is to be so long that a watchdog ends it. `work`: of each pair of the
/// batch.
std::vector<std::vector<PairRange>> cutPieces(const std::vector<std::vector<PairRange>>& submissions,
                                              std::span<const double> work, const Tuning& tuning);

/// A piece of two pairs or more, cut in two.
std::array<PairRange, 2> halvesOf(const PairRange& piece);

/// The meshes of one piece, by the numbers that its tasks have for them.
class PieceMeshes {
 public:
  /// All meshes of the batch: tasks keep the numbers that they have.
  void takeAll(const std::vector<const CollisionMesh*>& ofBatch);
  /// None of so many; use() adds those that are needed, where not all of a batch fit at once.
  void clear(std::size_t ofBatch);
  void use(const std::vector<const CollisionMesh*>& ofBatch, std::uint32_t mesh);

  /// Gives tasks the numbers of this piece.
  void renumber(std::span<otg_batch_task> tasks) const;
  const std::vector<const CollisionMesh*>& list() const { return meshes_; }

 private:
  std::vector<const CollisionMesh*> meshes_;
  std::vector<std::uint32_t> numbers_;  ///< from the batch's to those of the piece; empty: they are the same
};

}  // namespace otg::opencl
