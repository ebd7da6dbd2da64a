// SPDX-License-Identifier: BSD-3-Clause
// The container of cooked meshes (bvh/cooked_bytes.h), written down a second time for tests that change its bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace otg::test {

using Bytes = std::vector<unsigned char>;

inline std::uint64_t read64(const Bytes& bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value |= std::uint64_t{bytes[at + i]} << (8 * i);
  return value;
}
inline void write64(Bytes& bytes, std::size_t at, std::uint64_t value) {
  for (std::size_t i = 0; i < 8; ++i) bytes[at + i] = static_cast<unsigned char>(value >> (8 * i));
}
inline std::uint32_t read32(const Bytes& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{bytes[at + i]} << (8 * i);
  return value;
}
inline void write32(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<unsigned char>(value >> (8 * i));
}

/// The checksum of all but the last 8 bytes.
inline std::uint64_t checksumOf(const Bytes& bytes) {
  const auto turned = [](std::uint64_t word, int by) { return word << by | word >> (64 - by); };
  const auto mixed = [&](std::uint64_t lane, std::uint64_t a, std::uint64_t b) {
    return turned((turned(lane ^ a, 41) ^ b) * 0x9e3779b97f4a7c15u, 29);
  };
  std::uint64_t lane[8] = {1, 2, 3, 4, 5, 6, 7, 8};
  const std::size_t size = bytes.size() - 8, whole = size / 128 * 128;
  for (std::size_t i = 0; i < whole; i += 16) {
    std::uint64_t& l = lane[i / 16 % 8];
    l = mixed(l, read64(bytes, i), read64(bytes, i + 8));
  }
  for (std::size_t i = whole; i < size; i += 8) lane[0] = mixed(lane[0], read64(bytes, i), 0);
  std::uint64_t sum = size;
  for (const std::uint64_t l : lane) sum = mixed(sum, l, 0);
  return sum;
}
/// Makes the checksum right.
inline void seal(Bytes& bytes) {
  write64(bytes, bytes.size() - 8, checksumOf(bytes));
}

struct Section {
  std::size_t entry;  ///< where its size is written
  std::size_t at, size;
};

inline std::vector<Section> sectionsOf(const Bytes& bytes) {
  std::vector<Section> sections;
  const std::size_t count = read64(bytes, 24);
  std::size_t at = 64 + (8 * count + 63) / 64 * 64;
  for (std::size_t i = 0; i < count; ++i) {
    sections.push_back({64 + 8 * i, at, read64(bytes, 64 + 8 * i)});
    at += (sections.back().size + 63) / 64 * 64;
  }
  return sections;
}

}  // namespace otg::test
