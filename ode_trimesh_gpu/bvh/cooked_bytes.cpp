// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/cooked_bytes.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>
#if __has_include(<sys/mman.h>)
#include <sys/mman.h>
#endif

#include "base/system.h"

namespace otg {
namespace {

constexpr char kMagic[8] = "OTGMESH";
constexpr std::size_t kHeader = 64, kFooter = 8, kMostSections = 256;
/// What is read at once: its sum is taken while it is still in the processor's cache.
constexpr std::size_t kPiece = std::size_t{1} << 18;
constexpr std::size_t kHugePage = std::size_t{1} << 21;

constexpr std::uint64_t roundUp(std::uint64_t size, std::uint64_t to) {
  return (size + to - 1) / to * to;
}

std::uint64_t readWord(const unsigned char* at) {
  std::uint64_t word;
  std::memcpy(&word, at, sizeof(word));
  if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap64(word);
  return word;
}

void writeWord(unsigned char* at, std::uint64_t word) {
  for (int i = 0; i < 8; ++i) at[i] = static_cast<unsigned char>(word >> (8 * i));
}

void swapWords(unsigned char* bytes, std::size_t size, std::size_t word) {
  if constexpr (std::endian::native == std::endian::little) return;
  for (std::size_t i = 0; i + word <= size; i += word) std::reverse(bytes + i, bytes + i + word);
}

/// Without the turns, a change of the highest bit would never reach another one, and two of them would cancel out.
void mix(std::uint64_t& lane, std::uint64_t first, std::uint64_t second) {
  lane = std::rotl((std::rotl(lane ^ first, 41) ^ second) * 0x9e3779b97f4a7c15u, 29);
}

/// Uninitialised, and in huge pages where it is large and the system has them: to hand out small ones one by one would
/// take longer than to read what goes into them.
std::shared_ptr<unsigned char> makeBlock(std::size_t size, std::size_t alignment) {
  void* memory = nullptr;
#ifdef MADV_HUGEPAGE
  if (size >= kHugePage / 2) {
    const std::size_t whole = static_cast<std::size_t>(roundUp(size, kHugePage));
    memory = allocateAligned(kHugePage, whole);
    if (memory != nullptr) madvise(memory, whole, MADV_HUGEPAGE);
  }
#endif
  if (memory == nullptr) memory = allocateAligned(alignment, size);
  if (memory == nullptr) throw std::bad_alloc();
  return {static_cast<unsigned char*>(memory), freeAligned};
}

}  // namespace

void CookedSum::add(const unsigned char* bytes, std::size_t size) {
  static_assert(kStride == 16 * kLanes);
  std::uint64_t lane[kLanes];
  std::copy(lane_, lane_ + kLanes, lane);
  std::size_t i = 0;
  for (; i + kStride <= size; i += kStride) {
    for (std::size_t k = 0; k < kLanes; ++k)
      mix(lane[k], readWord(bytes + i + 16 * k), readWord(bytes + i + 16 * k + 8));
  }
  for (; i < size; i += 8) mix(lane[0], readWord(bytes + i), 0);
  std::copy(lane, lane + kLanes, lane_);
  size_ += size;
}

std::uint64_t CookedSum::sum() const {
  std::uint64_t sum = size_;
  for (const std::uint64_t l : lane_) mix(sum, l, 0);
  return sum;
}

std::uint64_t cookedChecksum(const unsigned char* bytes, std::size_t size) {
  CookedSum sum;
  sum.add(bytes, size);
  return sum.sum();
}

std::vector<unsigned char> CookedWriter::finish(std::uint32_t version) const {
  constexpr std::size_t kAlignment = CookedReader::kAlignment;
  std::size_t length = kHeader + roundUp(8 * sections_.size(), kAlignment);
  for (const Section& section : sections_) length += roundUp(section.size, kAlignment);
  length = roundUp(length + kFooter, kAlignment);
  std::vector<unsigned char> bytes(length, 0);
  std::memcpy(bytes.data(), kMagic, sizeof kMagic);
  writeWord(&bytes[8], version);
  writeWord(&bytes[16], length);
  writeWord(&bytes[24], sections_.size());
  std::size_t at = kHeader + roundUp(8 * sections_.size(), kAlignment);
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    const Section& section = sections_[i];
    writeWord(&bytes[kHeader + 8 * i], section.size);
    if (section.size > 0) std::memcpy(&bytes[at], section.data, section.size);
    swapWords(&bytes[at], section.size, section.word);
    at += roundUp(section.size, kAlignment);
  }
  writeWord(&bytes[length - kFooter], cookedChecksum(bytes.data(), length - kFooter));
  return bytes;
}

std::string CookedReader::open(ByteSource& source, std::uint64_t size, std::uint32_t version) {
  unsigned char header[kHeader] = {};
  const std::size_t first = source.read(header, static_cast<std::size_t>(std::min<std::uint64_t>(size, kHeader)));
  if (first < sizeof kMagic || std::memcmp(header, kMagic, sizeof kMagic) != 0) return "This is no cooked mesh.";
  if (first < 16) return "The cooked mesh is cut off.";
  const std::uint64_t its = readWord(header + 8), length = readWord(header + 16);
  if (its != version) {
    return "The cooked mesh is of version " + std::to_string(its) + "; this library reads version " +
           std::to_string(version) + ".";
  }
  if (first < kHeader || length > size) return "The cooked mesh is cut off.";
  if (length != size) return "There is more than the cooked mesh.";
  if (length % kAlignment != 0 || length < kHeader + kAlignment) return "The cooked mesh is damaged.";
  source_ = &source;
  length_ = static_cast<std::size_t>(length);
  block_ = makeBlock(length_, kAlignment);
  std::memcpy(block_.get(), header, kHeader);
  filled_ = kHeader;
  const std::uint64_t count = readWord(header + 24);
  if (count > kMostSections || kHeader + 8 * count > length) return {};
  while (filled_ < kHeader + 8 * count) {
    if (!readPiece()) return {};
  }
  if (!findSections(static_cast<std::size_t>(count))) sections_.clear();
  return {};
}

bool CookedReader::readPiece() {
  if (source_ == nullptr || filled_ == length_) return false;
  const std::size_t begin = filled_ / kPiece * kPiece, end = std::min(begin + kPiece, length_);  // the header is there
  const std::size_t got = source_->read(block_.get() + filled_, end - filled_);
  if (got != end - filled_) {
    source_ = nullptr;  // it has no more
    return false;
  }
  filled_ = end;
  sum_.add(block_.get() + begin, end == length_ ? end - begin - kFooter : end - begin);
  return true;
}

std::string CookedReader::finish() {
  while (readPiece()) {
  }
  if (filled_ != length_) return "The cooked mesh is cut off.";
  return sum_.sum() == readWord(block_.get() + length_ - kFooter) ? "" : "The cooked mesh is damaged.";
}

bool CookedReader::findSections(std::size_t count) {
  std::size_t at = kHeader + roundUp(8 * count, kAlignment);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t size = readWord(block_.get() + kHeader + 8 * i);
    if (at > length_ || size > length_ - at) return false;
    sections_.emplace_back(block_.get() + at, static_cast<std::size_t>(size));
    at += roundUp(size, kAlignment);
  }
  return roundUp(at + kFooter, kAlignment) == length_;
}

void CookedReader::swap(std::size_t number, std::size_t begin, std::size_t end, std::size_t word) const {
  swapWords(sections_[number].data() + begin, end - begin, word);
}

}  // namespace otg
