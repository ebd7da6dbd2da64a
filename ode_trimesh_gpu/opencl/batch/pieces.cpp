// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/batch/pieces.h"

#include <algorithm>

namespace otg::opencl {

std::vector<std::vector<PairRange>> cutBatch(std::size_t pairs, const Tuning& tuning, bool inOnePiece) {
  const std::size_t most = std::max(1u, tuning.batchPairs), pieces = inOnePiece ? 1 : std::max(1u, tuning.pieces);
  std::vector<std::vector<PairRange>> submissions;
  for (std::size_t from = 0; from < pairs; from += most) {
    const std::size_t end = std::min(pairs, from + most);
    const std::size_t step = std::max<std::size_t>({1, tuning.leastPiece, (end - from + pieces - 1) / pieces});
    std::vector<PairRange>& submission = submissions.emplace_back();
    for (std::size_t at = from; at < end; at += step) submission.push_back({at, std::min(step, end - at)});
  }
  return submissions;
}

std::array<PairRange, 2> halvesOf(const PairRange& piece) {
  const std::size_t half = piece.count / 2;
  return {PairRange{piece.begin, half}, PairRange{piece.begin + half, piece.count - half}};
}

void PieceMeshes::takeAll(const std::vector<const CollisionMesh*>& ofBatch) {
  if (numbers_.empty() && meshes_.size() == ofBatch.size()) return;  // they are there
  meshes_ = ofBatch;
  numbers_.clear();
}

void PieceMeshes::clear(std::size_t ofBatch) {
  numbers_.assign(ofBatch, kNone);
  meshes_.clear();
}

void PieceMeshes::use(const std::vector<const CollisionMesh*>& ofBatch, std::uint32_t mesh) {
  if (numbers_[mesh] != kNone) return;
  numbers_[mesh] = static_cast<std::uint32_t>(meshes_.size());
  meshes_.push_back(ofBatch[mesh]);
}

void PieceMeshes::renumber(std::span<otg_batch_task> tasks) const {
  if (numbers_.empty()) return;
  for (otg_batch_task& task : tasks) {
    task.meshA = numbers_[task.meshA];
    task.meshB = numbers_[task.meshB];
  }
}

}  // namespace otg::opencl
