// SPDX-License-Identifier: BSD-3-Clause
// Arrays in one piece of bytes, with a name, a version, a length and a checksum, that are used where they were read.
//
// The format, all numbers little end first; everything begins at a multiple of 64 bytes:
//   8  "OTGMESH" and a zero byte
//   4  version, 4 zero
//   8  length of the whole in bytes
//   8  number of sections, 32 zero
//   8  for each section: its number of bytes
//   the sections
//   zeros, and in the last 8 bytes the checksum of all that
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/array.h"

namespace otg {

/// The checksum of the format. Pairs of words of 64 bits are mixed into eight lanes in turn, which a processor works on
/// at once, faster than it reads memory. A change of a single word is found for sure; others are but for one chance in
/// 2^64. `size` is a multiple of 8.
std::uint64_t cookedChecksum(const unsigned char* bytes, std::size_t size);

/// Numbers of what size an array consists of.
template <class T>
constexpr std::size_t wordOf() {
  if constexpr (sizeof(T) == 1) return 1;
  if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::uint64_t>) return 8;
  return 4;
}

class CookedWriter {
 public:
  /// An Array or a SharedArray. Not copied before finish().
  template <class Elements>
  void add(const Elements& array) {
    using T = typename Elements::value_type;
    sections_.push_back({array.data(), array.size() * sizeof(T), wordOf<T>()});
  }
  std::vector<unsigned char> finish(std::uint32_t version) const;

 private:
  struct Section {
    const void* data;
    std::size_t size, word;
  };
  std::vector<Section> sections_;
};

/// Where bytes come from.
class ByteSource {
 public:
  ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;
  virtual ~ByteSource() = default;
  /// The next ones. Fewer than `size` when there are no more.
  virtual std::size_t read(unsigned char* to, std::size_t size) = 0;
};

/// The sum of bytes that come one after another.
class CookedSum {
 public:
  /// `size` is a multiple of 8, and of kStride for all parts but the last.
  void add(const unsigned char* bytes, std::size_t size);
  std::uint64_t sum() const;
  static constexpr std::size_t kStride = 128;

 private:
  static constexpr std::size_t kLanes = 8;
  std::uint64_t lane_[kLanes] = {1, 2, 3, 4, 5, 6, 7, 8};
  std::uint64_t size_ = 0;
};

/// Reads sections in their order, in pieces that are still in the processor's cache when they are summed up and looked
/// at. Until finish() has found the sum right, what was read may be anything.
class CookedReader {
 public:
  /// Reads what comes before the sections. Returns why the bytes are refused, in one sentence, or nothing. There are no
  /// sections then where their sizes are wrong.
  std::string open(ByteSource& source, std::uint64_t size, std::uint32_t version);
  std::size_t sections() const { return sections_.size(); }
  /// Sets the array to where section `number` will be. False where that has no whole number of elements.
  template <class Elements>
  bool place(std::size_t number, Elements& array) const {
    using T = typename Elements::value_type;
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlignment);
    const std::span<unsigned char> bytes = sections_[number];
    if (bytes.size() % sizeof(T) != 0) return false;
    array = Elements(block_, reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T));
    return true;
  }
  /// Reads a section, those before it having been read, and calls look(begin, end) for the elements that have come in
  /// since the last call.
  template <class Elements, class Look>
  void read(std::size_t number, const Elements& array, Look&& look) {
    using T = typename Elements::value_type;
    for (std::size_t end = 0; end < array.size();) {
      const std::size_t have = std::min<std::size_t>(array.size(), available(number) / sizeof(T));
      if (have > end) {
        swap(number, end * sizeof(T), have * sizeof(T), wordOf<T>());
        look(end, have);
        end = have;
      } else if (!readPiece()) {
        return;
      }
    }
  }
  /// Reads what is left. Returns why all of it is refused, or nothing.
  std::string finish();

 private:
  friend class CookedWriter;
  static constexpr std::size_t kAlignment = 64;
  bool findSections(std::size_t count);
  bool readPiece();
  /// The bytes of a section that were read, or what follows it too.
  std::size_t available(std::size_t number) const {
    const auto begin = static_cast<std::size_t>(sections_[number].data() - block_.get());
    return filled_ < begin ? 0 : filled_ - begin;
  }
  void swap(std::size_t number, std::size_t begin, std::size_t end, std::size_t word) const;

  ByteSource* source_ = nullptr;
  std::shared_ptr<unsigned char> block_;
  std::size_t length_ = 0, filled_ = 0;
  CookedSum sum_;
  std::vector<std::span<unsigned char>> sections_;
};

}  // namespace otg
