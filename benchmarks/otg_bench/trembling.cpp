// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/trembling.h"

#include <algorithm>
#include <chrono>

namespace otg::cli {
namespace {

constexpr int kPlaces = 64;

/// Planes and rays stay where they are.
void tremble(dGeomID mover, const dReal* at, int step) {
  const dReal by = 1e-7 * (step % 3 - 1);
  if (dGeomGetClass(mover) != dPlaneClass && dGeomGetClass(mover) != dRayClass)
    dGeomSetPosition(mover, at[0] + by, at[1] + by, at[2] - by);
}

}  // namespace

void addPose(dGeomID other, dGeomID mover, int repeat, TremblingRun& run) {
  dContactGeom contacts[kPlaces];
  dVector3 at{};
  if (dGeomGetClass(mover) != dPlaneClass) std::copy_n(dGeomGetPosition(mover), 3, at);
  int count = 0;
  const auto measure = [&](bool trembles) {
    std::vector<double> times;
    for (int i = 0; i <= repeat; ++i) {
      if (trembles) tremble(mover, at, i);
      const auto start = std::chrono::steady_clock::now();
      count = dCollide(other, mover, kPlaces, contacts, sizeof(dContactGeom));
      const auto end = std::chrono::steady_clock::now();
      if (i > 0) times.push_back(std::chrono::duration<double, std::micro>(end - start).count());
    }
    return median(times);
  };
  run.stillTimes.push_back(measure(false));
  run.contacts += static_cast<std::uint64_t>(count);
  run.hash.add(count);
  for (int i = 0; i < count; ++i) {
    addToHash(run.hash, contacts[i]);
    run.hash.add(contacts[i].side1);
  }
  run.times.push_back(measure(true));
  tremble(mover, at, 1);  // back where it was
}

Json compare(const TremblingRun& ours, const TremblingRun& stock) {
  const double mine = median(ours.times), theirs = median(stock.times);
  const auto poses = static_cast<double>(ours.times.size());
  return {{"us", mine},
          {"still_us", median(ours.stillTimes)},
          {"us_of_dtrimesh", theirs},
          {"times", mine / theirs},
          {"contacts", static_cast<double>(ours.contacts) / poses},
          {"contacts_of_dtrimesh", static_cast<double>(stock.contacts) / poses},
          {"hash", ours.hash.hex()}};
}

}  // namespace otg::cli
