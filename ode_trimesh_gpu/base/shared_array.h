// SPDX-License-Identifier: BSD-3-Clause
// An array that does not change any more, shared by all its copies.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace otg {

/// Made from a vector, or from a part of a block, such as a file that was read in one piece. The elements live as long
/// as any copy. A copy takes no memory and no time, and may be read by another thread.
template <class T>
class SharedArray {
 public:
  using value_type = T;

  SharedArray() = default;
  SharedArray(std::vector<T>&& elements) {  // NOLINT(google-explicit-constructor): takes a vector's place
    if (elements.empty()) return;
    auto block = std::make_shared<const std::vector<T>>(std::move(elements));
    data_ = block->data();
    size_ = block->size();
    block_ = std::move(block);
  }
  /// `data` lies in the block and begins where a T may.
  SharedArray(std::shared_ptr<const void> block, const T* data, std::size_t size) noexcept
      : block_(std::move(block)), data_(data), size_(size) {}

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T* data() const { return data_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  const T& back() const { return data_[size_ - 1]; }

 private:
  std::shared_ptr<const void> block_;
  const T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace otg
