// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points on the device, in pieces: while it works on one, the host takes the answers of the one before and
// writes the next.
#include <algorithm>
#include <memory>

#include "opencl/backend_state.h"

namespace otg::opencl {
namespace {

constexpr std::size_t kUnderWay = 2;

/// A lane with a piece.
struct PointPiece {
  std::unique_ptr<PointLane> lane;
  std::size_t begin = 0, end = 0;
};

}  // namespace

bool Backend::answersPoints() const {
  return state_->context.info().doubles;
}

std::size_t Backend::askPoints(const CollisionMesh& mesh, PointWish wish, std::size_t count, const FillPoints& fill,
                               const TakePoints& take) {
  state_->pointsAsked += count;
  std::size_t taken = 0;
  try {
    PointPiece pieces[kUnderWay];
    const std::size_t most = std::max<std::size_t>(1, state_->tuning.pointPiece);
    // All pieces of one size, and a small array in two if it is worth it.
    const std::size_t least = std::max<std::size_t>(1, state_->tuning.leastPointPiece);
    const std::size_t parts = std::max({(count + most - 1) / most, std::min(kUnderWay, count / least), std::size_t{1}});
    const std::size_t size = (count + parts - 1) / parts;
    std::size_t begun = 0;
    for (std::size_t turn = 0; taken < count; ++turn) {
      PointPiece& piece = pieces[turn % kUnderWay];
      if (piece.end > taken) {
        const std::span<const otg_uint> answers = piece.lane->end();
        take(piece.begin, piece.end, piece.lane->points().data(), answers.data());
        taken = piece.end;
      }
      if (begun == count) continue;
      if (!piece.lane) piece.lane = state_->points.take();
      piece.begin = begun;
      piece.end = std::min(count, begun + size);
      fill(piece.begin, piece.end, piece.lane->makeRoom(piece.end - piece.begin).data());
      piece.lane->begin(mesh, wish);
      begun = piece.end;
    }
    for (PointPiece& piece : pieces) {
      if (piece.lane) state_->points.keep(std::move(piece.lane), 0);
    }
  } catch (const ClError& error) {
    logError(error);
    state_->pointsOnHost += count - taken;
  }
  return taken;
}

}  // namespace otg::opencl
