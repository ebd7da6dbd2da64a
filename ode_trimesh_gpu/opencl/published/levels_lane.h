// SPDX-License-Identifier: BSD-3-Clause
// The traversal `levels` (kernels/published/levels_*.cl), one query at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "opencl/lanes/pair_lane.h"
#include "opencl/published/levels.h"
#include "opencl/published/prefix_sum.h"

namespace otg::opencl {

/// One thread at a time. After a ClError the lane is of no further use.
class LevelsLane {
 public:
  /// `meshes`: with the layout kBinary.
  LevelsLane(Context& context, MeshStore& meshes, const Tuning& tuning);
  LevelsLane(const LevelsLane&) = delete;
  LevelsLane& operator=(const LevelsLane&) = delete;

  /// As PairLane::run, but for the counts of box tests and of pairs of triangles, which are in steps(). Throws ClError.
  PairAnswer run(const Query& query, const PairFrame& frame, bool contacts, const LevelsOptions& how);

  /// Of the last query.
  const std::vector<LevelsStep>& steps() const { return steps_; }
  std::uint64_t bytesSent() const { return bytesSent_; }
  const Profile& profile() const { return profile_; }
  /// Times that a list was too short and a step was done again.
  std::uint64_t repeats() const { return repeats_; }

 private:
  /// A mesh as it is sent, kept on the host between queries.
  struct SentMesh {
    std::weak_ptr<const void> of;
    PackedMesh mesh;
  };
  /// The kernels of the near phase for one way of deciding, made when first asked for.
  struct NearKernels {
    Kernel near;  ///< tests; with contacts if fused
    Kernel rest;  ///< levelsEnter if fused, else pairResults
  };
  NearKernels& nearKernels(bool fused, bool contacts, bool reduce);
  PairAnswer runOn(const otg_device_pair& pair, const Query& query, cl_mem meshes, bool contacts,
                   const LevelsOptions& how);
  const PackedMesh& packed(const CollisionMesh& mesh, int side);
  void walk(const otg_device_pair& pair, const Query& query, cl_mem meshes, std::uint32_t startDepth);
  std::uint32_t begin(const Query& query, std::uint32_t startDepth);
  void step(const otg_device_pair& pair, cl_mem meshes, std::uint32_t count);
  void distribute(const otg_device_pair& pair, cl_mem meshes, std::uint32_t count, LevelsStep& counts);
  PairAnswer decide(const otg_device_pair& pair, const Query& query, cl_mem meshes, bool contacts, bool fused);
  void enqueueNear(const otg_device_pair& pair, const Query& query, cl_mem meshes, const otg_reduction& how,
                   bool contacts, bool reduce, bool fused);
  void write(cl_mem to, std::size_t offset, std::size_t bytes, const void* from);
  void growLeaves(std::uint64_t places);

  Context& context_;
  MeshStore& meshes_;
  const Tuning tuning_;
  const std::size_t group_, groups_;
  QueueHandle queue_;
  Kernel begin_, test_, compact_, split_, spawn_, reset_;
  NearKernels near_[2][3];  ///< by fused; pairs alone, contacts, contacts to be reduced
  PrefixSum sumOfOne_, sumOfTwo_;
  BufferHandle counters_, totals_;
  DeviceList starts_{sizeof(cl_uint)}, now_{sizeof(cl_uint2)}, next_{sizeof(cl_uint2)}, overlaps_{sizeof(cl_uint)},
      places_{sizeof(cl_uint)}, kept_{sizeof(cl_uint2)}, weights_{sizeof(cl_uint2)}, placesOfTwo_{sizeof(cl_uint2)},
      leaves_{sizeof(cl_uint2)}, hits_{sizeof(cl_uint2)}, sentUnits_{sizeof(MeshUnit)};
  std::unique_ptr<SentMesh> sent_[2];
  std::vector<cl_uint> startNodes_;
  std::vector<LevelsStep> steps_;
  std::uint32_t leafCount_ = 0;
  std::uint64_t bytesSent_ = 0;
  ResultBuffer results_;
  ChosenBuffer chosen_;
  Reducer reducer_;
  Profile profile_;
  std::uint64_t repeats_ = 0;
};

}  // namespace otg::opencl
