// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/cost/plan.h"

#include <algorithm>
#include <cmath>

namespace otg {
namespace {

/// Sums over pairs from the first one on, for each device and for one thread of the CPU.
class CostSums {
 public:
  CostSums(const Division& division, std::span<const CostModel> devices) : size_(division.work.size()) {
    const auto sumsOf = [&](const auto& cost) {
      std::vector<double> sums(size_ + 1, 0);
      for (std::size_t i = 0; i < size_; ++i) sums[i + 1] = sums[i] + cost(isSolid(division, i), division.work[i]);
      return sums;
    };
    bool any[2] = {false, false};  // of either model
    for (std::size_t i = 0; i < size_; ++i) any[isSolid(division, i) ? 1 : 0] = true;
    for (std::size_t d = 0; d < devices.size(); ++d) {
      const CostModel& device = devices[d];
      launch_.push_back(device.launchCost(any[0], any[1]));
      sums_.push_back(d > 0 && devices[d] == devices[d - 1] ? sums_.back() : sumsOf([&](bool solid, double work) {
        return device.deviceCost(solid, work);
      }));
    }
    host_ = sumsOf([&](bool solid, double work) { return devices[0].hostCost(solid, work); });
  }
  std::size_t size() const { return size_; }
  std::size_t devices() const { return sums_.size(); }
  /// Without the launch.
  double onDevice(std::size_t device, std::size_t begin, std::size_t end) const {
    return sums_[device][end] - sums_[device][begin];
  }
  double onHost(std::size_t begin, std::size_t end) const { return host_[end] - host_[begin]; }
  /// Of a batch of all of them.
  double launch(std::size_t device) const { return launch_[device]; }

 private:
  static bool isSolid(const Division& division, std::size_t i) {
    return !division.solid.empty() && division.solid[i] != 0;
  }
  std::size_t size_;
  std::vector<std::vector<double>> sums_;
  std::vector<double> launch_, host_;
};

/// The last end, from `begin` on, for which a device is done in time; `begin` if there is none.
std::size_t lastEnd(const CostSums& sums, std::size_t device, std::size_t begin, double time) {
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
std::vector<std::size_t> fill(const CostSums& sums, double time) {
  std::vector<std::size_t> ends;
  for (std::size_t d = 0; d < sums.devices(); ++d) {
    ends.push_back(lastEnd(sums, d, ends.empty() ? 0 : ends.back(), time));
  }
  return ends;
}

/// The first begin, up to `end`, for which a device is done in time.
std::size_t firstBegin(const CostSums& sums, std::size_t device, std::size_t end, double time) {
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
std::vector<std::size_t> even(const CostSums& sums, double time) {
  const std::size_t devices = sums.devices();
  std::vector<std::size_t> ends = fill(sums, time);
  const std::size_t last = ends.back();
  std::vector<std::size_t> least(devices, last);  // what the devices behind cannot do
  for (std::size_t d = devices - 1; d > 0; --d) least[d - 1] = firstBegin(sums, d, least[d], time);
  std::size_t begin = 0;
  for (std::size_t d = 0; d < devices; ++d) {
    const double share = sums.onDevice(d, begin, last) / static_cast<double>(devices - d) + sums.launch(d);
    std::size_t end = std::min(lastEnd(sums, d, begin, share), last);
    // The nearest to an equal share.
    if (end < last && share - sums.launch(d) - sums.onDevice(d, begin, end) > 0.5 * sums.onDevice(d, end, end + 1)) {
      ++end;
    }
    const std::size_t most = std::min(lastEnd(sums, d, begin, time), last);
    ends[d] = std::clamp(end, std::min(std::max(least[d], begin), most), most);
    begin = ends[d];
  }
  return ends;
}

}  // namespace

bool largeOnDevices(std::span<const double> work, std::span<const CostModel> devices, unsigned threads) {
  if (work.empty() || devices.empty()) return false;
  double rate = 0, onHost = 0;  // of all devices: parts of the whole in a microsecond
  for (const CostModel& device : devices) {
    double all = device.launchCost(false, true);
    for (const double one : work) all += device.deviceCost(true, one);
    rate += 1 / std::max(all, 1e-9);
  }
  for (const double one : work) onHost += devices[0].hostCost(true, one);
  return 1 / rate < onHost / devices[0].speedup(threads);
}

std::vector<std::size_t> divide(const Division& division, std::span<const CostModel> devices) {
  if (devices.empty()) return {};
  const CostSums sums(division, devices);
  const auto hostTime = [&](std::size_t begin) {
    // Pairs are not cut: the last one begun keeps one thread for itself.
    return (division.hostBusy + sums.onHost(begin, sums.size())) / devices[0].speedup(division.threads);
  };
  const auto fits = [&](const std::vector<std::size_t>& ends, double time) {
    return ends.back() >= division.bound && (ends.back() == sums.size() || hostTime(ends.back()) <= time);
  };
  double high = 1;
  for (std::size_t d = 0; d < devices.size(); ++d) {
    high = std::max(high, sums.launch(d) + sums.onDevice(d, 0, sums.size()));
  }
  high = 2 * std::max(high, hostTime(0)) + 1;
  double low = 0;
  for (int i = 0; i < 60 && high - low > 1e-6 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (fits(fill(sums, middle), middle) ? high : low) = middle;
  }
  return even(sums, high);
}

double shareToTake(const Leftover& leftover) {
  const double sum = leftover.host + leftover.device;
  if (!(sum > 0) || !(leftover.host > leftover.launch)) return 0;
  const double share =
      std::min(1.0, (leftover.host - leftover.launch) / sum);  // launch + share device = (1 - share) host
  return share >= 0.1 ? share : 0;
}

}  // namespace otg
