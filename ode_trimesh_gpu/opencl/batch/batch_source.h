// SPDX-License-Identifier: BSD-3-Clause
// Where the pairs of a batch come from.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "base/hash.h"
#include "collide/pair_history.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "opencl/backend.h"
#include "opencl/results/reducer.h"
#include "opencl/run_parts.h"
#include "shared/layout/device_layout.h"

namespace otg::opencl {

/// Numbers for meshes in the order of first appearance: open addressing, because it is searched twice for each pair.
class MeshNumbers {
 public:
  explicit MeshNumbers(std::vector<const CollisionMesh*>& meshes) : meshes_(meshes), slots_(256, 0) {}

  std::uint32_t operator()(const CollisionMesh* mesh) {
    if (2 * meshes_.size() >= slots_.size()) grow();
    std::uint32_t& slot = slots_[find(mesh)];
    if (slot == 0) {
      meshes_.push_back(mesh);
      slot = static_cast<std::uint32_t>(meshes_.size());
    }
    return slot - 1;
  }

 private:
  std::size_t find(const CollisionMesh* mesh) const {
    const std::size_t mask = slots_.size() - 1;
    const auto bits = static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(mesh));
    std::size_t at = spreadBits(bits) & mask;
    while (slots_[at] != 0 && meshes_[slots_[at] - 1] != mesh) at = (at + 1) & mask;
    return at;
  }
  void grow() {
    slots_.assign(2 * slots_.size(), 0);
    for (std::uint32_t i = 0; i < meshes_.size(); ++i) slots_[find(meshes_[i])] = i + 1;
  }
  std::vector<const CollisionMesh*>& meshes_;
  std::vector<std::uint32_t> slots_;  ///< number plus one, 0: free
};

inline bool sameReduction(const CollideOptions& x, const CollideOptions& y) {
  return x.reduction.method == y.reduction.method && x.reduction.bins == y.reduction.bins &&
         x.maxContacts == y.maxContacts && x.solid == y.solid;
}

/// How contacts of either model are chosen, for a pair that may have contacts of the model `solid`.
struct SolidReductions {
  std::vector<otg_reduction>& table;
  std::uint32_t find(const otg_reduction& how) {
    std::uint32_t at = 0;
    while (at < table.size() && std::memcmp(&table[at], &how, sizeof how) != 0) ++at;
    if (at == table.size()) table.push_back(how);
    return at;
  }
  /// `byHost`: as solidReduction. Where the contour does not close the CPU makes the contacts of shells.
  std::uint32_t solid(const CollideOptions& options, bool byHost) { return find(solidReduction(options, byHost, 0)); }
};

inline bool isSolid(const CollisionMesh* mesh) {
  return mesh->mesh().meshClass() == MeshClass::kSolid;
}

/// Queries as a caller has them: side by side, or each somewhere.
class QueryList {
 public:
  explicit QueryList(std::span<const Query> queries) : first_(queries.data()), size_(queries.size()) {}
  explicit QueryList(std::span<const Query* const> queries) : pointers_(queries.data()), size_(queries.size()) {}
  std::size_t size() const { return size_; }
  const Query& operator[](std::size_t i) const { return pointers_ != nullptr ? *pointers_[i] : first_[i]; }

 private:
  const Query* first_ = nullptr;
  const Query* const* pointers_ = nullptr;
  std::size_t size_;
};

/// The meshes of pairs that one thread looks at side by side.
struct PartMeshes {
  std::vector<const CollisionMesh*> own;  ///< in the order of their first appearance in the part
  std::vector<std::uint32_t> numbers;     ///< of these, among the meshes of all parts
};

/// Numbers the meshes of all parts in the order of their first appearance.
inline void numberMeshes(std::span<PartMeshes> parts, std::vector<const CollisionMesh*>& meshes) {
  MeshNumbers number(meshes);
  for (PartMeshes& part : parts) {
    for (const CollisionMesh* mesh : part.own) part.numbers.push_back(number(mesh));
  }
}

/// Calls look(begin, end) for parts of kPart of `count` pairs, by threads if there are any.
template <class Look>
void lookByParts(const RunParts& onHost, std::size_t count, const Look& look) {
  runParts(onHost ? &onHost : nullptr, count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; at += kPart) look(at, std::min(at + kPart, end));
  });
}

/// Such queries, each with options of its own. They are looked at in parts, each of which numbers meshes and reductions
/// for itself; these are then numbered for all, in the order of their first appearance.
class QuerySource {
 public:
  /// Pairs that may have contacts of the model `solid` are left to the CPU unless the device `makesSolids`. `onHost`:
  /// threads that help; may be empty.
  QuerySource(const QueryList& queries, bool makesSolids, const RunParts& onHost = {})
      : queries_(queries), heads_(queries.size()), parts_(partsOf(queries.size())), meshes_(parts_.size()) {
    lookByParts(onHost, queries.size(), [this](std::size_t begin, std::size_t end) { look(begin, end); });
    numberMeshes(meshes_, meshes);
    SolidReductions all{reductions};
    for (Part& part : parts_) {
      for (const auto& [options, kind] : part.reductions) {
        part.reductionNumbers.push_back(kind.solid ? all.solid(*options, kind.burdened || !makesSolids)
                                                   : all.find(deviceReduction(*options, false)));
        anyPairwise = anyPairwise || !kind.solid;
        anySolid = anySolid || kind.solid;
        anyHistory = anyHistory || kind.history;
        anyConvexPath = anyConvexPath || kind.convexPath;
      }
    }
  }

  std::vector<const CollisionMesh*> meshes;
  std::vector<otg_reduction> reductions;
  bool anyPairwise = false, anySolid = false, anyHistory = false;
  bool anyConvexPath = false;                 ///< some are left to the CPU if both meshes are convex
  static constexpr bool kIsScattered = true;  ///< what fill() reads lies all over the memory

  std::size_t size() const { return queries_.size(); }
  const Query& query(std::size_t i) const { return queries_[i]; }
  void fill(std::size_t i, otg_batch_task& task) const {
    const Head& head = heads_[i];
    const std::vector<std::uint32_t>& numbers = meshes_[i / kPart].numbers;
    task.bInA = queries_[i].bInA;
    task.meshA = numbers[head.meshA];
    task.meshB = numbers[head.meshB];
    task.reduction = parts_[i / kPart].reductionNumbers[head.reduction];
    task.skip = 0;
  }

 private:
  struct Kind {
    bool solid, history, burdened, convexPath;
    bool operator==(const Kind&) const = default;
  };
  /// Numbers of the query's part.
  struct Head {
    std::uint32_t meshA, meshB, reduction;
  };
  struct Reduction {
    const CollideOptions* options;
    Kind kind;
  };
  struct Part {
    std::vector<Reduction> reductions;            ///< no two in a row alike
    std::vector<std::uint32_t> reductionNumbers;  ///< of these, among those of all parts
  };

  static Kind kindOf(const Query& query) {
    Kind kind{};
    kind.solid = !isPairwise(query);
    kind.history = kind.solid && query.history != nullptr;
    kind.burdened = kind.history && !isUnburdened(stateBefore(query));
    kind.convexPath = kind.solid && query.options.solid.convexPath;
    return kind;
  }

  /// One part.
  void look(std::size_t begin, std::size_t end) {
    Part& part = parts_[begin / kPart];
    MeshNumbers number(meshes_[begin / kPart].own);
    for (std::size_t i = begin; i < end; ++i) {
      const Query& query = queries_[i];
      const Kind kind = kindOf(query);
      const Reduction* const last = part.reductions.empty() ? nullptr : &part.reductions.back();
      if (last == nullptr || !(kind == last->kind) || !sameReduction(*last->options, query.options)) {
        part.reductions.push_back({&query.options, kind});
      }
      const auto reduction = static_cast<std::uint32_t>(part.reductions.size() - 1);
      heads_[i] = {number(query.a), number(query.b), reduction};
    }
  }

  QueryList queries_;
  std::vector<Head> heads_;
  std::vector<Part> parts_;
  std::vector<PartMeshes> meshes_;  ///< of each part
};

/// Pairs of which the batch finds only whether they meet.
class PosedSource {
 public:
  /// `onHost`: threads that help; may be empty.
  explicit PosedSource(std::span<const PosedMeshes* const> pairs, const RunParts& onHost)
      : pairs_(pairs), heads_(pairs.size()), meshes_(partsOf(pairs.size())) {
    lookByParts(onHost, pairs.size(), [this](std::size_t begin, std::size_t end) {
      MeshNumbers number(meshes_[begin / kPart].own);
      for (std::size_t i = begin; i < end; ++i) heads_[i] = {number(pairs_[i]->a), number(pairs_[i]->b)};
    });
    numberMeshes(meshes_, meshes);
    reductions.push_back(deviceReduction(CollideOptions(), false));
  }

  std::vector<const CollisionMesh*> meshes;
  std::vector<otg_reduction> reductions;
  static constexpr bool anyPairwise = true, anySolid = false, anyHistory = false, kIsScattered = true;
  static constexpr bool anyConvexPath = false;

  std::size_t size() const { return pairs_.size(); }
  Query query(std::size_t i) const { return queryOf(*pairs_[i]); }
  void fill(std::size_t i, otg_batch_task& task) const {
    const std::vector<std::uint32_t>& numbers = meshes_[i / kPart].numbers;
    task.bInA = pairs_[i]->bInA;
    task.meshA = numbers[heads_[i].meshA];
    task.meshB = numbers[heads_[i].meshB];
    task.reduction = 0;
    task.skip = 0;
  }

 private:
  struct Head {  ///< numbers of the pair's part
    std::uint32_t meshA, meshB;
  };
  std::span<const PosedMeshes* const> pairs_;
  std::vector<Head> heads_;
  std::vector<PartMeshes> meshes_;  ///< of each part
};

/// Pairs of meshes that are numbered already, with the same options for all.
class PairSource {
 public:
  /// `makesSolids`: as QuerySource.
  PairSource(const NumberedPairs& batch, bool makesSolids)
      : meshes(batch.meshes.begin(), batch.meshes.end()), batch_(batch) {
    // Some of the pairs may have contacts of solids, some not: see mayBeShells.
    const bool asked = batch.options.contacts == ContactModel::kSolid;
    for (const CollisionMesh* mesh : meshes) isSolid_.push_back(asked && isSolid(mesh) ? 1 : 0);
    const auto solids = std::count(isSolid_.begin(), isSolid_.end(), 1);
    const bool allSolid = static_cast<std::size_t>(solids) == meshes.size();
    anySolid = solids > 0;
    anyPairwise = !allSolid;
    anyConvexPath = anySolid && batch.options.solid.convexPath;
    SolidReductions all{reductions};
    if (anyPairwise) pairwise_ = all.find(deviceReduction(batch.options, false));
    if (anySolid) solid_ = all.solid(batch.options, !makesSolids);
  }

  std::vector<const CollisionMesh*> meshes;
  std::vector<otg_reduction> reductions;
  bool anyPairwise = false, anySolid = false, anyConvexPath = false;
  static constexpr bool anyHistory = false, kIsScattered = false;

  std::size_t size() const { return batch_.pairs.size(); }
  Query query(std::size_t i) const {
    const MeshPair& pair = batch_.pairs[i];
    Query query;
    query.a = meshes[pair.a];
    query.b = meshes[pair.b];
    query.bInA = pair.bInA;
    query.options = batch_.options;
    return query;
  }
  void fill(std::size_t i, otg_batch_task& task) const {
    const MeshPair& pair = batch_.pairs[i];
    task.bInA = pair.bInA;
    task.meshA = pair.a;
    task.meshB = pair.b;
    task.reduction = isSolid_[pair.a] != 0 || isSolid_[pair.b] != 0 ? solid_ : pairwise_;
    task.skip = 0;
  }

 private:
  const NumberedPairs& batch_;
  std::uint32_t solid_ = 0, pairwise_ = 0;  ///< reductions
  std::vector<std::uint8_t> isSolid_;       ///< and contacts of the model `solid` are requested
};

}  // namespace otg::opencl
