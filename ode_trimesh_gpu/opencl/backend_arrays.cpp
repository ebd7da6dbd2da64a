// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points and of rays on the device, in pieces: while it works on one, the CPU takes the results of the one
// before and writes the next.
#include <algorithm>
#include <atomic>
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

/// Begins with each piece and hands its results over; `taken`: how many items have theirs, when an exception comes
/// through, too.
template <class Lane>
void inPieces(LanePool<Lane>& lanes, const Tuning& tuning, const CollisionMesh& mesh,
              const typename Lane::Request& request, std::size_t count, std::size_t& taken,
              const FillItems<typename Lane::Item>& fill, const TakeItems<typename Lane::Item>& take) {
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
    piece.lane->begin(mesh, request);
    begun = piece.end;
  }
  for (ArrayPiece<Lane>& piece : pieces) {
    if (piece.lane) lanes.keep(std::move(piece.lane), 0);
  }
}

/// What was queried is counted in `asked`, what is left to the caller in `onHost`.
template <class Lane>
std::size_t askArray(LanePool<Lane>& lanes, const Tuning& tuning, const CollisionMesh& mesh,
                     const typename Lane::Request& request, std::size_t count,
                     const FillItems<typename Lane::Item>& fill, const TakeItems<typename Lane::Item>& take,
                     std::atomic<std::uint64_t>& asked, std::atomic<std::uint64_t>& onHost) {
  asked += count;
  std::size_t taken = 0;
  try {
    inPieces(lanes, tuning, mesh, request, count, taken, fill, take);
  } catch (const ClError& error) {
    logError(error);
    onHost += count - taken;
  }
  return taken;
}

}  // namespace

bool Backend::answersPoints() const {
  return state_->answersArrays("queries/point_query.cl");
}

bool Backend::answersRays() const {
  return state_->answersArrays("queries/ray_query.cl");
}

bool Backend::answersDistances() const {
  return state_->answersArrays("queries/batch_distance.cl");
}

std::size_t Backend::failedPrograms() const {
  return state_->context.programs().failedCount();
}

std::size_t Backend::askPoints(const CollisionMesh& mesh, PointRequest request, std::size_t count,
                               const FillPoints& fill, const TakePoints& take) {
  return askArray(state_->points, state_->tuning, mesh, request, count, fill, take, state_->pointsAsked,
                  state_->pointsOnHost);
}

std::size_t Backend::castRays(const CollisionMesh& mesh, bool cullBack, std::size_t count, const FillRays& fill,
                              const TakeRays& take) {
  return askArray(state_->rays, state_->tuning, mesh, RayRequest{cullBack}, count, fill, take, state_->raysCast,
                  state_->raysOnHost);
}

}  // namespace otg::opencl
