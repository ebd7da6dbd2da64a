// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points and of rays on the device, in pieces: while it works on one, the host takes the answers of the one
// before and writes the next.
#include <algorithm>
#include <memory>

#include "opencl/backend.h"
#include "opencl/backend_state.h"

namespace otg::opencl {
namespace {

constexpr std::size_t kUnderWay = 2;

/// A lane with a piece.
template <class Lane>
struct ArrayPiece {
  std::unique_ptr<Lane> lane;
  std::size_t begin = 0, end = 0;
};

/// Calls start(lane) for each piece and hands its answers over; `taken`: how many items have theirs, when an exception
/// comes through, too.
template <class Lane, class Fill, class Start, class Take>
void inPieces(LanePool<Lane>& lanes, const Tuning& tuning, std::size_t count, std::size_t& taken, const Fill& fill,
              const Start& start, const Take& take) {
  ArrayPiece<Lane> pieces[kUnderWay];
  const std::size_t most = std::max<std::size_t>(1, tuning.pointPiece);
  // All pieces of one size, and a small array in two if it is worth it.
  const std::size_t least = std::max<std::size_t>(1, tuning.leastPointPiece);
  const std::size_t parts = std::max({(count + most - 1) / most, std::min(kUnderWay, count / least), std::size_t{1}});
  const std::size_t size = (count + parts - 1) / parts;
  std::size_t begun = 0;
  for (std::size_t turn = 0; taken < count; ++turn) {
    ArrayPiece<Lane>& piece = pieces[turn % kUnderWay];
    if (piece.end > taken) {
      const std::span<const otg_uint> answers = piece.lane->end();
      take(piece.begin, piece.end, piece.lane->items(), answers.data());
      taken = piece.end;
    }
    if (begun == count) continue;
    if (!piece.lane) piece.lane = lanes.take();
    piece.begin = begun;
    piece.end = std::min(count, begun + size);
    fill(piece.begin, piece.end, piece.lane->makeRoom(piece.end - piece.begin));
    start(*piece.lane);
    begun = piece.end;
  }
  for (ArrayPiece<Lane>& piece : pieces) {
    if (piece.lane) lanes.keep(std::move(piece.lane), 0);
  }
}

}  // namespace

bool Backend::answersArrays() const {
  return state_->context.info().doubles;
}

std::size_t Backend::askPoints(const CollisionMesh& mesh, PointWish wish, std::size_t count, const FillPoints& fill,
                               const TakePoints& take) {
  state_->pointsAsked += count;
  std::size_t taken = 0;
  try {
    inPieces(
        state_->points, state_->tuning, count, taken, fill, [&](PointLane& lane) { lane.begin(mesh, wish); }, take);
  } catch (const ClError& error) {
    logError(error);
    state_->pointsOnHost += count - taken;
  }
  return taken;
}

std::size_t Backend::castRays(const CollisionMesh& mesh, bool cullBack, std::size_t count, const FillRays& fill,
                              const TakeRays& take) {
  state_->raysCast += count;
  std::size_t taken = 0;
  try {
    inPieces(
        state_->rays, state_->tuning, count, taken, fill, [&](RayLane& lane) { lane.begin(mesh, cullBack); }, take);
  } catch (const ClError& error) {
    logError(error);
    state_->raysOnHost += count - taken;
  }
  return taken;
}

}  // namespace otg::opencl
