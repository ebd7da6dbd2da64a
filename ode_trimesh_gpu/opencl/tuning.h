// SPDX-License-Identifier: BSD-3-Clause
// The sizes of launches and buffers. Results do not depend on any of them; tests set them small to see that.
#pragma once

#include <cstdint>

namespace otg::opencl {

struct Tuning {
  std::uint32_t leafTriangles = 2;  ///< most triangles of a leaf, 1 to 8
  std::uint32_t group = 128;        ///< work-items of a work-group, a multiple of 64
  /// Levels that are opened breadth-first before work-groups go on depth-first, 2 at most; none for two meshes that
  /// have fewer triangles together than `levelTriangles`.
  std::uint32_t levels = 2, levelTriangles = 20000;
  std::uint32_t groupsPerUnit = 8;      ///< work-groups for each compute unit in kernels that stride over their work
  std::uint32_t batchGroup = 128;       ///< work-items for one pair of a batch, a multiple of 8, 32 at least
  std::uint32_t batchPairs = 1u << 16;  ///< pairs in one submission; more are done in several
  /// A batch is done in so many pieces, each begun before the one before is waited for, as long as these have
  /// `leastPiece` pairs.
  std::uint32_t pieces = 4, leastPiece = 2048;
  /// Triangles of all pairs in one launch that makes contacts; a pair counts twice its smaller mesh. Lumps of 5,120
  /// triangles whose regions are large take an H200 12 ms for so many; a watchdog may end what takes seconds.
  double batchWork = 4e7;
  std::uint64_t batchTriangles = 200000;  ///< contacts of larger pairs are not left to one work-group
  /// A single pair with more hits is the CPU's, and so is one of a batch: launches end soon. An H200 finds 138 million
  /// hits a second for a single pair.
  std::uint32_t mostHits = 1u << 21, batchHits = 1u << 16;
  /// Places in the lists between kernels. A list that is too short grows, and the query is run again.
  std::uint32_t pairPlaces = 1u << 16, leafPlaces = 1u << 16, hitPlaces = 1u << 14;
  std::uint32_t stackRoom = 512;    ///< pairs that a work-group stacks before it goes on with one at a time, 16 or more
  std::uint32_t recordGroup = 256;  ///< work-items of a work-group that makes contacts or finds regions, 64 at least
  /// A work-group finds the contacts of a pair of a batch by itself if the pair has at most `mediumHits` hits; there is
  /// one kernel for few of them and one for more. Powers of two.
  std::uint32_t smallHits = 128, mediumHits = 512, smallGroup = 64, mediumGroup = 256;
  /// The same for a single pair, where few hits are expected: with more, other kernels have to follow.
  std::uint32_t fewHits = 64, fewGroup = 64;
  std::uint32_t chooseGroup = 512;      ///< work-items that choose the contacts of a single pair
  std::uint32_t batchChooseGroup = 64;  ///< work-items that choose the contacts of one pair of a batch
  /// Contacts after binning, and regions, that one pair may have on the device, 1,024 at most. With more the CPU
  /// chooses.
  std::uint32_t keptPlaces = 1024, batchKeptPlaces = 256;
  std::uint32_t contactPlaces = 1u << 15;  ///< contacts that a batch may have; more grow the list, as above
  /// Where the last kernel of a single pair writes contacts: 0 on the device, from where they are read; 1 into
  /// host memory if the device can. Tests: 2 into an ordinary buffer that the host has mapped, which works on CPUs; 3
  /// the same, but what was written is not seen.
  std::uint32_t hostAnswers = 1;
  std::uint32_t flushes = 0;  ///< clFlush: 1 after the first launch of a query, 2 after the traversal, 3 after both
  bool reduce = true;         ///< find regions and reduce contacts on the device
  std::uint32_t recordsExpected = 512;  ///< read with the head of the results in the first query
  bool warmUp = true;                   ///< build the usual kernels when the device is opened, not at first use
  bool solid = true;                    ///< make contacts of the model `solid` on the device
  /// The device describes the overlap of a single pair of solids if the lane's last query had at least so many
  /// intersecting pairs of triangles; otherwise the CPU makes the contacts from these. 0: 256, and never on CPUs.
  std::uint32_t overlapHits = 0;
  std::uint32_t overlapGroup = 128;        ///< work-items of a work-group of its kernels, a multiple of 64
  std::uint32_t overlapGroupsPerUnit = 4;  ///< work-groups for each compute unit, at most: limited by register pressure
  std::uint32_t overlapUnits = 1u << 16;   ///< of 16 bytes, for the description; grows
  /// Pairs of a batch of solids whose regions are too large for its own kernels are described, too, if there are so
  /// many. This holds where single pairs are described; `overlapPairs` at a time.
  std::uint32_t leastOverlaps = 64, overlapPairs = 1024;
  /// 1: contacts of large regions of described pairs are made on the device, too; 0: the CPU makes them. Work-items of
  /// a work-group of those kernels, a power of two (0: 1 on CPUs, else what each is best with), and units of 16 bytes
  /// for their arena, which grows.
  std::uint32_t overlapContacts = 1, overlapLanes = 0, overlapArena = 1u << 16;
  /// Where a piece of a batch of solids leaves at most so many pairs to the CPU, its caller's threads do them
  /// meanwhile; those that it leaves at the last moment after all pieces.
  std::uint32_t meanwhile = 128;
  /// Pairs of solids of a batch are done by kernels with one size of lists in local memory, or with two; 0: one on
  /// CPUs, else two. `solidGroup` work-items (0: 1 on CPUs, else 32) do a pair of at most `solidHits` intersecting
  /// pairs of triangles (a power of two). Its regions have at most `solidPoints` points and `solidFaces` pieces; others
  /// are done by `solidLargeGroup` work-items (0: 1 on CPUs, else 64) if they have at most `solidLargeHits`, and else
  /// by the CPU.
  std::uint32_t solidSizes = 0, solidGroup = 0, solidLargeGroup = 0;
  std::uint32_t solidHits = 64, solidPoints = 112, solidFaces = 64, solidLargeHits = 256;
  /// Work-items that do an uneven region (0: 1 on CPUs, else 128), and pieces of the largest; the CPU does larger
  /// ones.
  std::uint32_t unevenGroup = 0, unevenFaces = 64;
  /// Registers that a work-item of their kernels may take where the device takes a limit; 0: as many as it likes.
  std::uint32_t solidRegisters = 128;
  std::uint32_t arenaUnits = 1u << 18;  ///< of 16 bytes, for regions of a batch of solids; grows
  /// Work-items of a work-group of the traversal `levels`, and how many numbers its prefix sums take at once; 4 at
  /// least.
  std::uint32_t levelsGroup = 256;
  /// Points or rays of an array are sent in pieces of so many at most, in two or more if these have `leastPointPiece`
  /// of them; `pointGroup` work-items of a work-group.
  std::uint32_t pointPiece = 1u << 18, leastPointPiece = 1u << 15, pointGroup = 64;
  /// Pairs of one submission whose distances are requested.
  std::uint32_t distancePairs = 1u << 14;
  double distanceWork = 12000;     ///< of one submission: microseconds that an H200 takes, about
  std::uint64_t memoryBudget = 0;  ///< bytes of all buffers; 0: half of the device's memory
  std::uint64_t meshBudget = 0;    ///< of these, bytes for meshes, those of `levels` among them; 0: half of the budget
  std::uint32_t cutOrder = 0;      ///< not 0: cuts in another order than PackedTree has them
  bool profile = false;            ///< take times of the stages of single queries, which costs some
  bool doubles = true;             ///< false: as on a device without double arithmetic
};

/// Pairs of nodes in the stack of a work-group: room for what one pair may still lead to is kept free beside the rest
/// (pairTail in kernels/walk/pair_query.cl). `depths`: of both trees together.
constexpr std::uint32_t stackSizeFor(const Tuning& tuning, std::uint32_t depths) {
  return tuning.stackRoom + 8 * depths + 8;
}

}  // namespace otg::opencl
