// SPDX-License-Identifier: BSD-3-Clause
// An array whose elements may lie in a larger piece of memory that several arrays share.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace otg {

/// Of a size that is settled when it is made. It comes from a vector or from a part of a block, such as a file that was
/// read in one piece; the block lives as long as any of its arrays. A copy has memory of its own. Who holds the array
/// may change its elements: no two arrays are made of one part.
template <class T>
class Array {
 public:
  using value_type = T;

  Array() = default;
  Array(std::vector<T>&& elements) noexcept  // NOLINT(google-explicit-constructor): takes a vector's place
      : own_(std::move(elements)), data_(own_.data()), size_(own_.size()) {}
  /// `data` lies in the block and begins where a T may.
  Array(std::shared_ptr<void> block, T* data, std::size_t size) noexcept
      : block_(std::move(block)), data_(data), size_(size) {
    static_assert(std::is_trivially_copyable_v<T>);
  }
  Array(const Array& other) : Array(std::vector<T>(other.begin(), other.end())) {}
  Array(Array&& other) noexcept { swap(other); }
  Array& operator=(const Array& other) {
    if (this != &other) *this = Array(other);
    return *this;
  }
  Array& operator=(Array&& other) noexcept {
    Array taken(std::move(other));
    swap(taken);
    return *this;
  }
  ~Array() = default;

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  void swap(Array& other) noexcept {
    own_.swap(other.own_);
    block_.swap(other.block_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
  }

  std::vector<T> own_;           ///< empty where the elements lie in a block
  std::shared_ptr<void> block_;  ///< null where they are own_
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace otg
