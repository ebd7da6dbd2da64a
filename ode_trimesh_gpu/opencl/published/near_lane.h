// SPDX-License-Identifier: BSD-3-Clause
// The near phase on the device for candidates from anywhere (kernels/published/contacts_first.cl, levels_near.cl).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collide/pair_frame.h"
#include "opencl/meshes/mesh_store.h"
#include "opencl/published/near_phase.h"
#include "opencl/results/result_buffer.h"
#include "opencl/runtime/given.h"
#include "opencl/tuning.h"
#include "shared/layout/published_given.h"

namespace otg::opencl {

/// The triangles that candidates name, each once, as they are sent.
class GatheredTriangles {
 public:
  /// Pairs whose triangles have no area are left out.
  void gather(const Query& query, std::span<const TrianglePair> candidates);
  /// Triangles of A, then of B, three units each. `pairs`: places of both in these.
  const std::vector<otg_mesh_unit>& units() const { return units_; }
  const std::vector<otg_place_pair>& pairs() const { return pairs_; }
  /// How many of A.
  std::uint32_t countA() const { return countA_; }

 private:
  /// Places of a mesh's triangles, by number, between two calls none.
  struct Places {
    std::vector<std::uint32_t> of, taken;
    std::uint32_t take(std::uint32_t triangle);
    void begin(std::size_t triangles);
    void append(const TriMesh& mesh, std::vector<otg_mesh_unit>& units);
  };
  Places a_, b_;
  std::vector<otg_mesh_unit> units_;
  std::vector<otg_place_pair> pairs_;
  std::uint32_t countA_ = 0;
};

/// One thread at a time. After a ClError the lane is of no further use.
class NearLane {
 public:
  /// Meshes are not used: triangles come with every query.
  NearLane(Context& context, MeshStore& meshes, const Tuning& tuning);

  /// Records of the candidates that intersect or that only the CPU can decide, with contacts if `contacts` and the
  /// device has doubles. Without doubles the filter comes first. Good until the next call. Throws ClError.
  Answer run(const Query& query, const PairFrame& frame, std::span<const TrianglePair> candidates, NearOrder order,
             bool contacts);

  /// Of the last query; the times but for `host` and `total`.
  const NearReport& report() const { return report_; }
  /// Times that a list was too short and a step was done again.
  std::uint64_t repeats() const { return repeats_; }

 private:
  struct Kernels {
    KernelFor<given::ContactsFirst> contactsFirst;
    KernelFor<given::LevelsNearFused> filterFirst;
    KernelFor<given::LevelsEnd> end;
  };
  Kernels& kernels(bool contacts);
  void send();
  void enqueue(const otg_device_pair& pair, const Query& query, NearOrder order, bool contacts);

  Context& context_;
  const std::size_t group_, groups_;
  const bool doubles_;
  QueueHandle queue_;
  Kernels kernels_[2];  ///< pairs alone, contacts
  GatheredTriangles gathered_;
  ListOf<otg_mesh_unit> triangles_;
  ListOf<otg_place_pair> pairs_;
  ListOf<otg_counter> counters_;
  ResultBuffer results_;
  Profile profile_;
  NearReport report_;
  std::uint32_t hitPlaces_;
  std::uint64_t repeats_ = 0;
};

}  // namespace otg::opencl
