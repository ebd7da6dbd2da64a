// SPDX-License-Identifier: BSD-3-Clause
// Keeping the contacts that span the convex cone of all contact wrenches.
#include <algorithm>
#include <cstddef>
#include <queue>

#include "collide/contact_order.h"
#include "collide/contact_wrench.h"
#include "collide/convex_cone.h"
#include "collide/pairwise/reduction.h"

namespace otg {
namespace {

/// Farthest-first growth of a cone. The distance of a wrench from a growing cone never rises, so the last known
/// distance is an upper bound. Only the wrench on top of a queue has to be brought up to date. The residual of a
/// projection shows which new rays matter to it (those with a positive component along it); most do not, and then
/// nothing is solved.
class ConeGreedy {
 public:
  /// `contacts` deepest first: the first one is always kept, and ties go to the smaller index.
  ConeGreedy(std::span<const Contact> contacts, double tolerance) : tolerance_(tolerance), states_(contacts.size()) {
    const WrenchFrame frame(contacts);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      states_[i].wrench = frame.wrench(contacts[i]);
      states_[i].length = states_[i].wrench.norm();
    }
    keep(0);
    for (std::uint32_t i = 1; i < states_.size(); ++i) reopen(i);
  }

  void run() {
    grow();
    prune();
    grow();
  }

  bool isKept(std::size_t i) const { return states_[i].kept; }

 private:
  struct State {
    Wrench wrench;
    double length;
    ConeProjection<6> projection;
    std::uint32_t seen = 0;  // rays below this number are accounted for in `projection`
    bool kept = false;
  };
  struct Open {
    double distance;  // over the wrench's length; an upper bound
    std::uint32_t state;
    bool operator<(const Open& other) const {
      return distance != other.distance ? distance < other.distance : state > other.state;
    }
  };

  void keep(std::uint32_t i) {
    states_[i].kept = true;
    cone_.add(states_[i].wrench);
    owner_.push_back(i);
  }

  void reopen(std::uint32_t i) {
    State& s = states_[i];
    s.projection = ConeProjection<6>{};
    s.projection.residual = s.wrench;
    s.seen = 0;
    queue_.push({1.0, i});
  }

  /// True when a ray that came since changes the projection.
  bool isStale(State& s) const {
    const double threshold = 1e-12 * s.length;
    for (; s.seen < cone_.size(); ++s.seen) {
      if (cone_.ray(s.seen).dot(s.projection.residual) > threshold) return true;
    }
    return false;
  }

  void grow() {
    while (!queue_.empty()) {
      const Open top = queue_.top();
      queue_.pop();
      State& s = states_[top.state];
      if (isStale(s)) {
        s.projection = cone_.project(s.wrench, tolerance_ * s.length, s.projection);
        s.seen = cone_.size();
        const double distance = s.projection.distance() / s.length;
        if (distance > tolerance_) queue_.push({distance, top.state});
      } else {
        keep(top.state);
      }
    }
  }

  /// The farthest wrench need not be extreme, so some early choices have come to lie inside the cone of later ones.
  /// They leave, and whatever was proven with their help is proven again.
  void prune() {
    constexpr double kInside = 1e-9;
    std::vector<std::uint8_t> pruned(cone_.size(), 0);
    for (std::uint32_t ray = 1; ray < cone_.size(); ++ray) {
      const State& s = states_[owner_[ray]];
      cone_.disable(ray);
      if (cone_.project(s.wrench, kInside * s.length).distance() <= kInside * s.length) {
        pruned[ray] = 1;
      } else {
        cone_.enable(ray);
      }
    }
    for (std::uint32_t ray = 1; ray < pruned.size(); ++ray) {
      if (pruned[ray]) states_[owner_[ray]].kept = false;
    }
    for (std::uint32_t i = 0; i < states_.size(); ++i) {
      const State& s = states_[i];
      if (s.kept) continue;
      const auto end = s.projection.rays.begin() + s.projection.count;
      const bool usesPruned =
          std::any_of(s.projection.rays.begin(), end, [&](std::uint32_t ray) { return pruned[ray] != 0; });
      if (usesPruned || s.projection.distance() > tolerance_ * s.length) reopen(i);
    }
  }

  double tolerance_;
  std::vector<State> states_;
  ConvexCone<6> cone_;
  std::vector<std::uint32_t> owner_;  // of each ray, its state
  std::priority_queue<Open> queue_;
};

}  // namespace

std::vector<Contact> reduceToCone(std::span<const Contact> contacts, double tolerance) {
  std::vector<Contact> sorted(contacts.begin(), contacts.end());
  if (sorted.size() < 2) return sorted;
  std::sort(sorted.begin(), sorted.end(), contactDeeper);
  ConeGreedy greedy(sorted, tolerance);
  greedy.run();
  std::vector<Contact> kept;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (greedy.isKept(i)) kept.push_back(sorted[i]);
  }
  std::sort(kept.begin(), kept.end(), contactLess);
  return kept;
}

double distanceToCone(const Contact& contact, std::span<const Contact> kept, std::span<const Contact> all) {
  const WrenchFrame frame(all);
  ConvexCone<6> cone;
  for (const Contact& c : kept) cone.add(frame.wrench(c));
  const Wrench w = frame.wrench(contact);
  return cone.project(w).distance() / w.norm();
}

}  // namespace otg
