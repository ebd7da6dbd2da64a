// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/plan.h"

#include <algorithm>
#include <cmath>

namespace otg {
namespace {

/// Sums over pairs from the first one on, for either model: of their work, and how many they are.
class WorkSums {
 public:
  explicit WorkSums(const Division& division) : size_(division.work.size()) {
    for (Sums& sums : sums_) {
      sums.work.assign(size_ + 1, 0);
      sums.count.assign(size_ + 1, 0);
    }
    for (std::size_t i = 0; i < size_; ++i) {
      const bool solid = !division.solid.empty() && division.solid[i] != 0;
      for (int m = 0; m < 2; ++m) {
        const bool counts = solid == (m == 1);
        sums_[m].work[i + 1] = sums_[m].work[i] + (counts ? division.work[i] : 0);
        sums_[m].count[i + 1] = sums_[m].count[i] + (counts ? 1 : 0);
      }
    }
  }
  std::size_t size() const { return size_; }
  /// Without the launch.
  double onDevice(const CostModel& device, std::size_t begin, std::size_t end) const {
    return cost(sums_[0], device.batchPair, begin, end) +
           cost(sums_[1], device.knowsSolids() ? device.batchSolid : device.batchPair, begin, end);
  }
  double onHost(const CostModel& costs, std::size_t begin, std::size_t end) const {
    return cost(sums_[0], costs.hostPairwise, begin, end) + cost(sums_[1], costs.hostSolid, begin, end);
  }
  /// Of a batch of all of them.
  double launch(const CostModel& device) const {
    return device.launchCost(sums_[0].count[size_] > 0, sums_[1].count[size_] > 0);
  }

 private:
  struct Sums {
    std::vector<double> work, count;
  };
  static double cost(const Sums& sums, const Cost& each, std::size_t begin, std::size_t end) {
    return each.fixed * (sums.count[end] - sums.count[begin]) + each.perTriangle * (sums.work[end] - sums.work[begin]);
  }
  std::size_t size_;
  Sums sums_[2];
};

/// The last end, from `begin` on, for which a device is done in time; `begin` if there is none.
std::size_t lastEnd(const WorkSums& sums, const CostModel& device, std::size_t begin, double time) {
  std::size_t low = begin, high = sums.size();
  while (low < high) {
    const std::size_t middle = low + (high - low + 1) / 2;
    if (sums.launch(device) + sums.onDevice(device, begin, middle) <= time) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

/// The blocks when every device does as much as it can in `time`.
std::vector<std::size_t> fill(const WorkSums& sums, std::span<const CostModel> devices, double time) {
  std::vector<std::size_t> ends;
  for (const CostModel& device : devices) ends.push_back(lastEnd(sums, device, ends.empty() ? 0 : ends.back(), time));
  return ends;
}

/// The first begin, up to `end`, for which a device is done in time.
std::size_t firstBegin(const WorkSums& sums, const CostModel& device, std::size_t end, double time) {
  std::size_t low = 0, high = end;
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (sums.launch(device) + sums.onDevice(device, middle, end) <= time) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return high;
}

/// Blocks that end where those of fill() do, and in the same time, but as equal as they can be: of few pairs the first
/// devices would take all.
std::vector<std::size_t> even(const WorkSums& sums, std::span<const CostModel> devices, double time) {
  std::vector<std::size_t> ends = fill(sums, devices, time);
  const std::size_t last = ends.back();
  std::vector<std::size_t> least(devices.size(), last);  // what the devices behind cannot do
  for (std::size_t d = devices.size() - 1; d > 0; --d) least[d - 1] = firstBegin(sums, devices[d], least[d], time);
  std::size_t begin = 0;
  for (std::size_t d = 0; d < devices.size(); ++d) {
    const CostModel& device = devices[d];
    const double share =
        sums.onDevice(device, begin, last) / static_cast<double>(devices.size() - d) + sums.launch(device);
    std::size_t end = std::min(lastEnd(sums, device, begin, share), last);
    // The nearest to an equal share.
    if (end < last &&
        share - sums.launch(device) - sums.onDevice(device, begin, end) > 0.5 * sums.onDevice(device, end, end + 1)) {
      ++end;
    }
    const std::size_t most = std::min(lastEnd(sums, device, begin, time), last);
    ends[d] = std::clamp(end, std::min(std::max(least[d], begin), most), most);
    begin = ends[d];
  }
  return ends;
}

}  // namespace

std::vector<std::size_t> divide(const Division& division, std::span<const CostModel> devices) {
  if (devices.empty()) return {};
  const WorkSums sums(division);
  const auto hostTime = [&](std::size_t begin) {
    // Pairs are not cut: the last one begun keeps one thread for itself.
    return (division.hostBusy + sums.onHost(devices[0], begin, sums.size())) / devices[0].speedup(division.threads);
  };
  const auto fits = [&](const std::vector<std::size_t>& ends, double time) {
    return ends.back() >= division.bound && (ends.back() == sums.size() || hostTime(ends.back()) <= time);
  };
  double high = 1;
  for (const CostModel& device : devices)
    high = std::max(high, sums.launch(device) + sums.onDevice(device, 0, sums.size()));
  high = 2 * std::max(high, hostTime(0)) + 1;
  double low = 0;
  for (int i = 0; i < 60 && high - low > 1e-6 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (fits(fill(sums, devices, middle), middle) ? high : low) = middle;
  }
  return even(sums, devices, high);
}

double shareToTake(const Leftover& leftover) {
  const double sum = leftover.host + leftover.device;
  if (!(sum > 0) || !(leftover.host > leftover.launch)) return 0;
  const double share =
      std::min(1.0, (leftover.host - leftover.launch) / sum);  // launch + share device = (1 - share) host
  return share >= 0.1 ? share : 0;
}

}  // namespace otg
