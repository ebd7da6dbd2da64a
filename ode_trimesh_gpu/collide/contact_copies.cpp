// SPDX-License-Identifier: BSD-3-Clause
#include "collide/contact_copies.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "base/vectors.h"
#include "collide/contact_order.h"

namespace otg {
namespace {

constexpr double kOnePlace = 1e-9;        // of the size
constexpr double kOneNormal = 1 - 1e-12;  // cosine

}  // namespace

void dropCopies(std::vector<Contact>& contacts, double size, std::pmr::memory_resource* memory) {
  const double near = kOnePlace * size;
  std::pmr::vector<std::size_t> along(contacts.size(), memory);
  std::iota(along.begin(), along.end(), std::size_t{0});
  std::sort(along.begin(), along.end(),
            [&](std::size_t i, std::size_t k) { return contacts[i].position.x < contacts[k].position.x; });
  std::pmr::vector<char> isCopy(contacts.size(), 0, memory);
  for (std::size_t i = 0; i < along.size(); ++i) {
    const Contact& c = contacts[along[i]];
    for (std::size_t k = i + 1; k < along.size() && contacts[along[k]].position.x - c.position.x <= near; ++k) {
      const Contact& other = contacts[along[k]];
      if (norm(other.position - c.position) > near || otgDot(other.normal, c.normal) < kOneNormal) continue;
      isCopy[contactDeeper(c, other) ? along[k] : along[i]] = 1;
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (isCopy[i] == 0) contacts[kept++] = contacts[i];
  }
  contacts.resize(kept);
}

}  // namespace otg
