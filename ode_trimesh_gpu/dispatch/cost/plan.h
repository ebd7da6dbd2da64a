// SPDX-License-Identifier: BSD-3-Clause
// How a batch is dealt out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dispatch/cost/cost_model.h"

namespace otg {

/// What is to be divided: pairs in a row, of which the first `bound` have to go to devices and the others may go to the
/// CPU as well.
struct Division {
  std::span<const double> work;         ///< expectedWork of each pair
  std::span<const std::uint8_t> solid;  ///< 1 for pairs of solids; empty if there are none
  std::size_t bound = 0;
  double hostBusy = 0;  ///< microseconds that the CPU's threads need for what is theirs anyway
  unsigned threads = 1;
};

/// Whether all pairs of solids with large overlaps, `work` each, go to devices. Devices that describe overlaps have the
/// CPU's threads finish them, which are missed if these have such pairs of their own meanwhile: so the pairs are not
/// divided, and go where all of them end sooner.
bool largeOnDevices(std::span<const double> work, std::span<const CostModel> devices, unsigned threads);

/// Ends of the devices' blocks: device d gets the pairs from the end of the block before it (0) to ends[d], the CPU
/// what is left. Chosen so that all are expected to be done at the same time; blocks of devices with equal models have
/// equal cost, and with as many pairs as devices or more none is left out. With the same arguments it gives the same
/// result.
std::vector<std::size_t> divide(const Division& division, std::span<const CostModel> devices);

/// What is left of a batch when a device has nothing to do any more; microseconds.
struct Leftover {
  double host = 0;    ///< that the CPU's threads still need
  double device = 0;  ///< that the device would need for all of it
  double launch = 0;  ///< and for a batch, however small
};

/// The part of the leftover, 0 to 1, that the device takes so that both are done at the same time; 0 if it would not
/// end sooner by a tenth.
double shareToTake(const Leftover& leftover);

}  // namespace otg
