// SPDX-License-Identifier: BSD-3-Clause
// What becomes of each pair of a batch: from what is known of it, and from the flags that the device gives it, to a
// fate. Pure functions: they need no device and change nothing.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shared/layout/solid_layout.h"

namespace otg::opencl {

/// Routing, in the order of rows; the first that holds decides.
///
/// | when                | what is known of the pair                                              | fate           |
/// |---------------------|------------------------------------------------------------------------|----------------|
/// | before it is sent   | its pose cannot be worked with                                         | kRefused       |
/// |                     | its meshes are too large for one work-group                            | kAlone         |
/// |                     | the CPU makes its frame, and a device could do nothing with it         | kWithoutDevice |
/// |                     | none of these                                                          | kDevice        |
/// | after the batch     | OTG_PAIR_REFUSED                                                       | kRefused       |
/// |                     | OTG_PAIR_NO_FRAME                                                      | kWithoutDevice |
/// |                     | OTG_PAIR_SKIPPED: its fate was known before it was sent                | kSettled       |
/// |                     | not OTG_PAIR_TO_HOST, or OTG_PAIR_INTERSECTS; records are not for all  | kDevice        |
/// |                     | the CPU has made its contacts while the device was at work             | kMeanwhile     |
/// |                     | the batch describes overlaps, and mayBeDescribed()                     | kDescribed     |
/// |                     | none of these                                                          | kRecords       |
/// | after a failed call | its pose cannot be worked with                                         | kRefused       |
/// |                     | the CPU has made its contacts while the device was at work             | kMeanwhile     |
/// |                     | none of these                                                          | kWithoutDevice |
///
/// While the device is at work its early flags are known: a pair with OTG_PAIR_TO_HOST, and with none of REFUSED,
/// NO_FRAME and SKIPPED, is left to the CPU then already (isLeftEarly). Three rules about numbers of pairs follow
/// those of single ones: isForHostMeanwhile, areWorthDescribing and mayWait.
enum class Fate : std::uint8_t {
  kDevice,         ///< the device does it, or has done it
  kRefused,        ///< it has no contacts, and the caller gets an error
  kAlone,          ///< the device does it by itself, as a single pair
  kWithoutDevice,  ///< the CPU does all of it
  kSettled,        ///< nothing more: one of the others was its fate before
  kMeanwhile,      ///< what the CPU has made is kept
  kDescribed,      ///< the device describes its overlap, and the CPU or the device makes contacts from that
  kRecords         ///< the CPU finishes it from the records of its triangles
};

/// Pairs that the device leaves out of its result, one way or another.
inline constexpr otg_uint kNotByDevice = OTG_PAIR_REFUSED | OTG_PAIR_TO_HOST | OTG_PAIR_NO_FRAME | OTG_PAIR_SKIPPED;

/// What is known of a pair before it is sent.
struct PairBefore {
  bool refused = false;  ///< its pose cannot be worked with
  bool large = false;    ///< more triangles than Tuning::batchTriangles, where such pairs are done alone
  bool idle = false;     ///< the CPU makes frames for the device, and this pair has none that is of use
  bool host = false;     ///< its contacts are of a kind that devices do not make
};
Fate fateBefore(const PairBefore& pair);

/// What is known of all pairs of a batch.
struct BatchRules {
  bool recordsOfAll = false;  ///< the device finds triangles, and the CPU makes everything else of them
  bool describes = false;     ///< overlaps are described where that is of use
};
/// `flags`: OTG_PAIR_* after the batch; `doneMeanwhile`: the CPU has made the pair's contacts.
Fate fateAfter(otg_uint flags, const BatchRules& rules, bool doneMeanwhile);
Fate fateAfterFailure(bool refused, bool doneMeanwhile);

/// Whether the early flags of a pair say that it is left to the CPU.
constexpr bool isLeftEarly(otg_uint flags) {
  return (flags & kNotByDevice) == OTG_PAIR_TO_HOST;
}

/// Whether the CPU would describe the pair's overlap by cells, or perhaps, and nothing else is in the way.
bool mayBeDescribed(otg_uint flags);

/// Whether a pair of a batch of solids has contacts of that model, or none, from the device: what it remembers is then
/// known.
constexpr bool isRemembered(otg_uint flags) {
  return (flags & (kNotByDevice | OTG_PAIR_PAIRWISE)) == 0;
}

/// Pairs of a piece that are left early: whether the CPU is to do them at once. For many it should have the
/// records, and overlaps may be described where there are `leastOverlaps` of them.
constexpr bool isForHostMeanwhile(std::size_t left, std::size_t describable, std::uint32_t most,
                                  std::uint32_t leastOverlaps) {
  return left <= most && describable < leastOverlaps;
}

/// Whether so many overlaps are described: for a few the CPU is faster, from records.
constexpr bool areWorthDescribing(std::size_t pairs, std::uint32_t leastOverlaps) {
  return pairs >= leastOverlaps;
}

/// Whether pairs of solids that the device left late wait for those of other pieces, so that threads do all of them at
/// once: a few do.
constexpr bool mayWait(std::size_t pairs, bool solids, bool hasThreads, std::uint32_t most) {
  return solids && hasThreads && pairs <= most;
}

}  // namespace otg::opencl
