// SPDX-License-Identifier: BSD-3-Clause
// Few elements sorted or parted so that the others keep their order. The standard library takes memory for that.
#pragma once

#include <algorithm>

namespace otg {

template <class Iterator, class IsBefore>
void insertionSort(Iterator begin, Iterator end, const IsBefore& isBefore) {
  for (Iterator next = begin; next != end; ++next) {
    std::rotate(std::upper_bound(begin, next, *next, isBefore), next, next + 1);
  }
}

/// std::stable_partition without memory of its own.
template <class Iterator, class IsFirst>
Iterator partitionInOrder(Iterator begin, Iterator end, const IsFirst& isFirst) {
  Iterator firstEnd = begin;
  for (Iterator next = begin; next != end; ++next) {
    if (!isFirst(*next)) continue;
    if (firstEnd != next) std::rotate(firstEnd, next, next + 1);
    ++firstEnd;
  }
  return firstEnd;
}

}  // namespace otg
