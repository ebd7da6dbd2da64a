// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/plan.h"

#include <algorithm>
#include <cmath>

namespace otg {
namespace {

/// Sums of the work of pairs from the first one on.
class WorkSums {
 public:
  explicit WorkSums(std::span<const double> work) : sums_(work.size() + 1, 0) {
    for (std::size_t i = 0; i < work.size(); ++i) sums_[i + 1] = sums_[i] + work[i];
  }
  std::size_t size() const { return sums_.size() - 1; }
  double cost(const Cost& each, std::size_t begin, std::size_t end) const {
    return each.fixed * static_cast<double>(end - begin) + each.perTriangle * (sums_[end] - sums_[begin]);
  }

 private:
  std::vector<double> sums_;
};

/// The blocks when every device works for `time` at most.
std::vector<std::size_t> fill(const WorkSums& sums, std::span<const CostModel> devices, double time) {
  std::vector<std::size_t> ends;
  std::size_t begin = 0;
  for (const CostModel& device : devices) {
    std::size_t low = begin, high = sums.size();
    while (low < high) {  // the largest end that is done in time
      const std::size_t middle = low + (high - low + 1) / 2;
      if (device.batchLaunch + sums.cost(device.batchPair, begin, middle) <= time) {
        low = middle;
      } else {
        high = middle - 1;
      }
    }
    ends.push_back(low);
    begin = low;
  }
  return ends;
}

}  // namespace

std::vector<std::size_t> divide(const Division& division, std::span<const CostModel> devices) {
  if (devices.empty()) return {};
  const WorkSums sums(division.work);
  const auto hostTime = [&](std::size_t begin) {
    // Pairs are not cut: the last one begun keeps one thread for itself.
    return (division.hostBusy + sums.cost(devices[0].hostPairwise, begin, sums.size())) / division.threads;
  };
  const auto fits = [&](const std::vector<std::size_t>& ends, double time) {
    return ends.back() >= division.bound && (ends.back() == sums.size() || hostTime(ends.back()) <= time);
  };
  double high = 1;
  for (const CostModel& device : devices)
    high = std::max(high, device.batchLaunch + sums.cost(device.batchPair, 0, sums.size()));
  high = 2 * std::max(high, hostTime(0)) + 1;
  double low = 0;
  for (int i = 0; i < 60 && high - low > 1e-6 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (fits(fill(sums, devices, middle), middle) ? high : low) = middle;
  }
  return fill(sums, devices, high);
}

}  // namespace otg
