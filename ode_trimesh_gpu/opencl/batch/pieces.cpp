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

std::vector<std::size_t> cutByWork(std::span<const double> work, double most) {
  std::vector<std::size_t> ends;
  double sum = 0;
  for (std::size_t i = 0; i < work.size(); ++i) {
    if (sum > 0 && sum + work[i] > most) {
      ends.push_back(i);
      sum = 0;
    }
    sum += work[i];
  }
  if (!work.empty()) ends.push_back(work.size());
  return ends;
}

std::vector<std::vector<PairRange>> cutPieces(const std::vector<std::vector<PairRange>>& submissions,
                                              std::span<const double> work, const Tuning& tuning) {
  const std::size_t atOnce = std::max(1u, tuning.pieces);
  std::vector<std::vector<PairRange>> out;
  for (const std::vector<PairRange>& pieces : submissions) {
    out.emplace_back();
    for (const PairRange& piece : pieces) {
      std::size_t begin = 0;
      for (const std::size_t end : cutByWork(work.subspan(piece.begin, piece.count), tuning.batchWork)) {
        if (out.back().size() == atOnce) out.emplace_back();
        out.back().push_back({piece.begin + begin, end - begin});
        begin = end;
      }
    }
  }
  return out;
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
