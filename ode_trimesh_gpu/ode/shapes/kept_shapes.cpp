// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/kept_shapes.h"

#include <utility>

namespace otg {

bool isKeptClass(int geomClass) noexcept {
  switch (geomClass) {
    case dBoxClass:
    case dCapsuleClass:
    case dCylinderClass:
    case dConvexClass:
      return true;
    default:
      return false;
  }
}

KeptShapes::Pose KeptShapes::ask(std::uint64_t key, const Transformd& pose) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  if (it != entries_.end() && samePose(it->second.query.pose, pose)) {
    return it->second.hasAnswer ? Pose::kAnswered : Pose::kAgain;
  }
  if (it == entries_.end() && entries_.size() >= kMost) entries_.clear();
  Entry& entry = it != entries_.end() ? it->second : entries_[key];
  entry.query.pose = pose;
  entry.hasAnswer = false;
  return Pose::kNew;
}

bool KeptShapes::find(std::uint64_t key, const ShapeQuery& query, int most, std::vector<Contact>& out) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  if (it == entries_.end()) return false;
  Entry& entry = it->second;
  if (!entry.hasAnswer || entry.most != most || !sameQuery(entry.query, query)) {
    entry.hasAnswer = false;
    return false;
  }
  out.assign(entry.contacts.begin(), entry.contacts.end());
  return true;
}

void KeptShapes::seen(std::uint64_t key, std::uint64_t stamp) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  if (it != entries_.end()) it->second.query.stamp = stamp;
}

void KeptShapes::reserve(std::uint64_t key, std::size_t contacts) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  if (it != entries_.end()) it->second.contacts.reserve(contacts);
}

void KeptShapes::keep(std::uint64_t key, ShapeQuery&& query, int most, const std::vector<Contact>& contacts) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  if (it == entries_.end() || !samePose(it->second.query.pose, query.pose)) return;
  Entry& entry = it->second;
  entry.query = std::move(query);
  entry.contacts.assign(contacts.begin(), contacts.end());
  entry.most = most;
  entry.hasAnswer = true;
}

}  // namespace otg
