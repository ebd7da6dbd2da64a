// SPDX-License-Identifier: BSD-3-Clause
// The results of pairs that stay where they are.
#pragma once

#include <cstdint>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "collide/query.h"
#include "ode/shapes/shape_query.h"

namespace otg {

/// Whether results of pairs with geoms of this class are kept: of others they are as quick as a look-up.
bool isKeptClass(int geomClass) noexcept;

/// Of one mesh's geom: for each geom of ODE's own the pose of the last query, and, once a pose has come twice, what was
/// found there. No result depends on it. Any number of threads.
class KeptShapes {
 public:
  /// What is known about a pose. Where it is kNew nothing is kept for the pair any more; it is that of the last query
  /// from now on. May throw std::bad_alloc.
  enum class Pose { kNew, kAgain, kAnswered };
  Pose ask(std::uint64_t key, const Transformd& pose);

  /// After kAnswered: whether the query is the same in all else, and its contacts, in the mesh's own numbers. May throw
  /// std::bad_alloc.
  bool find(std::uint64_t key, const ShapeQuery& query, int most, std::vector<Contact>& out);
  /// After find(): what is remembered of the pair has this stamp now.
  void seen(std::uint64_t key, std::uint64_t stamp);
  /// After kNew: makes room for as many contacts, so that what comes next takes no memory. May throw std::bad_alloc.
  void reserve(std::uint64_t key, std::size_t contacts);
  /// After kAgain: the result, with the stamp of what it left. May throw std::bad_alloc.
  void keep(std::uint64_t key, ShapeQuery&& query, int most, const std::vector<Contact>& contacts);

 private:
  struct Entry {
    ShapeQuery query;  ///< of its pose alone, as long as there is no result
    std::vector<Contact> contacts;
    int most = 0;
    bool hasAnswer = false;
  };
  static constexpr std::size_t kMost = 1024;
  std::mutex mutex_;
  std::unordered_map<std::uint64_t, Entry> entries_;  ///< by the key of memory
};

}  // namespace otg
