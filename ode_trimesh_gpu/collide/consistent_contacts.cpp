// SPDX-License-Identifier: BSD-3-Clause
#include "collide/consistent_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory_resource>
#include <numeric>
#include <tuple>

#include "base/vectors.h"
#include "collide/contact_wrench.h"
#include "collide/convex_cone.h"
#include "collide/pair_history.h"
#include "shared/contacts/uneven_model.h"

namespace otg {
namespace {

/// How long the motion may be, in depths of the deepest contact. In an acute groove a translation is as long.
constexpr double kLongest = OTG_UNEVEN_LONGEST;
/// A rotation counts by so many times what it moves the contact that is farthest from the middle of all. If it moves
/// the body by more, that counts. Otherwise contacts that press a body from two sides would agree by a long turn about
/// a place between them.
constexpr double kTurn = 3;

/// What a pair of some fifty contacts needs, without the heap.
class StackMemory {
 public:
  std::pmr::memory_resource* resource() { return &resource_; }

 private:
  alignas(std::max_align_t) std::array<std::byte, 16384> bytes_;
  std::pmr::monotonic_buffer_resource resource_{bytes_.data(), bytes_.size()};
};

double deepestOf(std::span<const Contact> contacts) {
  double deepest = 0;
  for (const Contact& c : contacts) deepest = std::max(deepest, c.depth);
  return deepest;
}

/// Whether one translation satisfies all contacts because their normals are much alike.
bool agreePlainly(std::span<const Contact> contacts) {
  Vec3d sum{0, 0, 0};
  for (const Contact& c : contacts) sum = otgAdd(sum, c.normal);
  const double least = norm(sum) / kLongest;
  return least > 0 && std::all_of(contacts.begin(), contacts.end(),
                                  [&](const Contact& c) { return otgDot(c.normal, sum) >= least; });
}

/// What contacts request of the motion x, each wrench . x >= depth, in units of the deepest.
class Requests {
 public:
  /// `contacts` have a depth, one of them at least.
  Requests(std::span<const Contact> contacts, double size, std::pmr::memory_resource* memory)
      : frame_(contacts, memory), deepest_(deepestOf(contacts)), cone_(memory) {
    const double radius = frame_.radius();
    if (size > kTurn * radius && radius > 0) turn_ = size / radius;
    cone_.reserve(contacts.size());
  }

  void add(const Contact& contact, bool isWhole) { cone_.add(ray(contact, isWhole)); }
  void replace(std::uint32_t i, const Contact& contact, bool isWhole) { cone_.replace(i, ray(contact, isWhole)); }
  void disable(std::uint32_t i) { cone_.disable(i); }
  void enable(std::uint32_t i) { cone_.enable(i); }

  /// Least distance programming (Lawson and Hanson, "Solving Least Squares Problems", 1974, chapter 23.4): of the
  /// vector (0, 1) what is left beside the cone of all (wrench, depth) is as long as 1 / sqrt(1 + x . x) for the
  /// shortest x.
  bool areSatisfiable() const {
    const double enough = 1 / std::sqrt(1 + kLongest * kLongest);
    return cone_.project(Ray::Unit(6), enough).distance() > enough;
  }

 private:
  using Ray = ConvexCone<7>::Vector;
  Ray ray(const Contact& contact, bool isWhole) const {
    Ray r;
    r << frame_.wrench(contact), isWhole ? contact.depth / deepest_ : 0.0;
    r.segment<3>(3) /= turn_;
    return r;
  }

  WrenchFrame frame_;
  double deepest_, turn_ = kTurn;
  ConvexCone<7> cone_;
};

}  // namespace

bool contradict(std::span<const Contact> contacts, double size) {
  if (contacts.size() < 2 || agreePlainly(contacts) || !(deepestOf(contacts) > 0)) return false;
  StackMemory memory;
  Requests all(contacts, size, memory.resource());
  for (const Contact& c : contacts) all.add(c, true);
  return !all.areSatisfiable();
}

void makeConsistent(std::vector<Contact>& contacts, double size) {
  if (!contradict(contacts, size)) return;
  StackMemory memory;
  std::pmr::vector<std::uint32_t> order(contacts.size(), memory.resource());
  std::iota(order.begin(), order.end(), 0U);
  // By the geometry alone.
  const auto key = [&](std::uint32_t i) {
    const Contact& c = contacts[i];
    return std::make_tuple(-c.depth, c.normal.x, c.normal.y, c.normal.z, c.position.x, c.position.y, c.position.z);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t x, std::uint32_t y) { return key(x) < key(y); });
  const auto end = std::find_if(order.begin(), order.end(), [&](std::uint32_t i) { return !(contacts[i].depth > 0); });
  const auto deep = static_cast<std::uint32_t>(end - order.begin());
  // Each of those with a depth starts by requesting that the two come no closer there: to stay does for that.
  Requests requests(contacts, size, memory.resource());
  for (std::uint32_t k = 0; k < order.size(); ++k) {
    requests.add(contacts[order[k]], false);
    if (k >= deep) requests.disable(k);
  }
  std::pmr::vector<std::uint8_t> isLeftOut(contacts.size(), 0, memory.resource());
  for (std::uint32_t k = 0; k < order.size(); ++k) {
    Contact& c = contacts[order[k]];
    if (k < deep) {
      requests.replace(k, c, true);
    } else {
      requests.enable(k);
    }
    if (requests.areSatisfiable()) continue;
    if (k < deep) {
      requests.replace(k, c, false);
      cutDepth(c, 0);
    } else {
      requests.disable(k);
      isLeftOut[order[k]] = 1;
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (isLeftOut[i] == 0) contacts[kept++] = contacts[i];
  }
  contacts.resize(kept);
}

bool isDeep(const Query& query, std::span<const Contact> contacts) {
  return deepestOf(contacts) >= SolidHistory::kClampedDepth * smallerSize(query);
}

bool cutContradictions(const Query& query, std::vector<Contact>& contacts) {
  const bool wasDeep = isDeep(query, contacts);
  const double deepest = deepestOf(contacts);
  makeConsistent(contacts, smallerRadius(query));
  return wasDeep && deepestOf(contacts) < deepest;
}

}  // namespace otg
