// SPDX-License-Identifier: BSD-3-Clause
// The lists and kernels by which a batch of pairs of solids gets its contacts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "opencl/results/reducer.h"
#include "opencl/results/result_buffer.h"
#include "opencl/tuning.h"
#include "shared/layout/solid_given.h"

namespace otg::opencl {

/// Part of one lane. Functions throw ClError.
class SmallStage {
 public:
  SmallStage(Context& context, const Tuning& tuning);

  /// Room for so many pairs, hits, and contacts of each pair. `anyPairwise`: for enqueuePairwise(), too.
  void reserve(std::uint32_t pairs, std::uint32_t hits, std::uint32_t places, bool anyPairwise);
  /// Whether the last batch had room for what it found about regions; if not, the next one has.
  bool fits(const otg_uint* counters);

  /// What a lane has of its batch when its pairs were walked.
  struct Batch {
    std::uint32_t count;
    cl_mem meshes, counters, tasks, pairs, places, hits;
    std::uint32_t hitPlaces;
    cl_mem records, states, reductions;
    std::size_t groups;
    std::byte* flags;      ///< gets the flags of the pairs, as far as their regions and ways out show; may be null
    EventHandle* flagged;  ///< then: when they are there
    /// Directions of deep regions, three doubles a pair: those of the last query, and where those of this one go; both
    /// may be null.
    const std::byte* directionsBefore;
    std::byte* directions;
  };
  /// After a batch: the records of the pairs that are left to the CPU, where each has its hits side by side. False if
  /// there was no room for them: then all records have to be looked at.
  bool readLeft(cl_command_queue queue, const otg_uint* counters, Answer& answer);
  /// The hits of each pair with the ends of their chords, in stretches that otg_pair_state gives.
  const DeviceList& hits() const { return sorted_; }
  /// Everything from the hits on, up to lists of contacts and their places in `chosen`.
  void enqueue(cl_command_queue queue, const Batch& batch, Reducer& reducer, const ChosenBuffer& chosen,
               Profile& profile);
  /// Between the two: the records, with contacts, of the pairs with OTG_PAIR_PAIRWISE.
  void enqueuePairwise(cl_command_queue queue, const Batch& batch, const ChosenBuffer& chosen, Profile& profile);
  BufferOf<otg_result_byte> pairwiseRecords() const { return pairwiseRecords_.bytes(); }
  /// `chosen` gets the results; the last kernel, which ends the batch.
  void enqueueWrite(cl_command_queue queue, const Batch& batch, const ChosenBuffer& chosen, Profile& profile);

 private:
  /// The large kernels, for pairs up to some size.
  struct Size {
    std::uint32_t group, hits, points, faces;
    std::uint32_t firstList, endList;  ///< of pairs that wait for them
    std::size_t groups;                ///< most work-groups at once; 0: one for each pair
    Kernel regions, ways, contacts;
  };
  void build();
  Context& context_;
  const std::uint32_t recordGroup_;
  const std::string registerLimit_;  ///< an option, or nothing
  std::uint32_t arenaWanted_, chunksWanted_, room_ = 0;
  ResultBuffer left_{0}, pairwiseRecords_{0};
  std::vector<Size> sizes_;  ///< the largest pairs first
  Kernel records_, stretches_, scatter_, estimate_, write_;
  KernelFor<given::SolidUneven> uneven_;
  KernelFor<given::SolidPairwise> pairwise_;
  std::size_t estimateGroup_, unevenGroup_, unevenFaces_, estimateGroups_;
  DeviceList sorted_{sizeof(otg_solid_hit)}, heads_{sizeof(otg_uint)}, arena_, lists_{sizeof(otg_uint)},
      chunks_{2 * sizeof(otg_uint)}, kept_{sizeof(otg_chosen_contact)}, directions_{3 * sizeof(double)};
};

}  // namespace otg::opencl
