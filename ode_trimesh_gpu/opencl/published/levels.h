// SPDX-License-Identifier: BSD-3-Clause
// How a query by the traversal `levels` is requested, and what is known of it afterwards. Free of OpenCL's types.
#pragma once

#include <cstdint>
#include <vector>

namespace otg::opencl {

/// How places in lists are found. All ways give the same places.
enum class PrefixSums {
  kPublished,      ///< log n additions for each number, block by block
  kWorkEfficient,  ///< two additions for each number, block by block
  kSinglePass      ///< one launch
};

/// The published design, kept as a baseline and as an oracle for the traversal that is used: one level of both binary
/// trees in each iteration, with the CPU reading the lengths of lists in between.
struct LevelsOptions {
  /// The nodes at this depth of both trees, and leaves above it, are tested all against all to begin with. 0: the
  /// roots.
  std::uint32_t startDepth = 6;
  /// What the device needs goes there with every query, as published; else it stays there. The mid phase alone needs
  /// nodes, of integers (QuantizedNode); with the narrow phase behind it, it needs triangles and their neighbours, too.
  bool sendTrees = false;
  bool fusedNear = true;  ///< one kernel tests triangles and makes contacts; else two
  PrefixSums prefixSums = PrefixSums::kPublished;
};
inline constexpr std::uint32_t kMostStartDepth = 12;

/// One iteration. `tests` pairs of nodes were tested, `overlapping` of them overlap, `leafPairs` of these are two
/// leaves; `spawned` pairs of children are what the next iteration tests.
struct LevelsStep {
  std::uint32_t depth = 0;  ///< of the nodes, where they are not leaves that ended earlier
  std::uint64_t tests = 0, overlapping = 0, leafPairs = 0, spawned = 0;
};

/// Milliseconds. Those from `upload` to `readBack` are the device's clock.
struct LevelsTimes {
  double upload = 0;      ///< trees and triangles, if they are sent; the nodes to start from
  double start = 0;       ///< the pairs to start from
  double test = 0;        ///< boxes
  double scan = 0;        ///< prefix sums
  double compaction = 0;  ///< pairs that overlap, moved together
  double split = 0;       ///< pairs of leaves, taken out
  double spawn = 0;       ///< pairs of children
  double near = 0;        ///< triangles; with fusedNear the contacts too
  double contacts = 0;    ///< without fusedNear
  double regions = 0;     ///< regions of contact, and bins
  double choose = 0;      ///< of the contacts in the bins, the limit
  double readBack = 0;    ///< lengths of lists, results
  double host = 0;        ///< what the device left, before the reduction
  double reduction = 0;   ///< on the CPU
  double total = 0;       ///< from call to return
};

struct LevelsReport {
  std::vector<LevelsStep> steps;
  std::uint64_t bytesSent = 0;  ///< trees, triangles and nodes to start from
  LevelsTimes times;            ///< if they were requested
};

}  // namespace otg::opencl
