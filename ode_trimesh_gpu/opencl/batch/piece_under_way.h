// SPDX-License-Identifier: BSD-3-Clause
// What a batch keeps of its pieces while a device has them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "opencl/lanes/batch_lane.h"
#include "opencl/results/take_records.h"

namespace otg::opencl {

struct PieceUnderWay {
  std::size_t begin, count;
  bool soon = false;                  ///< the lane tells early what it leaves to the CPU
  bool lacksMemory = false;           ///< that others' queries take
  std::unique_ptr<BatchLane> lane{};  ///< none if it could not be begun
  std::uint64_t repeats = 0;          ///< of the lane until then
  std::vector<std::size_t> alone{}, large{}, refused{};
  std::optional<ClError> error{};
};

/// One that has ended but for pairs that are being described.
struct DescribedPiece {
  std::unique_ptr<BatchLane> lane;
  std::uint64_t repeats;
  std::size_t begin, count;
  bool scattered;
  std::shared_ptr<const PieceRecords> records{};  ///< once they were needed
  std::optional<ClError> error{};                 ///< why they are not to be had
};

}  // namespace otg::opencl
