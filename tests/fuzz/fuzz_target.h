// SPDX-License-Identifier: BSD-3-Clause
// What every fuzz target has: an entry for libFuzzer, and the inputs that its corpus begins with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace otg::fuzz {

using Input = std::vector<std::uint8_t>;

/// Generated, the same each time.
std::vector<Input> seeds();

inline Input inputOf(const std::string& text) {
  return {text.begin(), text.end()};
}

/// What a target may take for granted. Ends the program where it does not hold, which libFuzzer reports.
inline void require(bool holds) {
  if (!holds) std::abort();
}

/// Numbers out of the input, zero when it is used up.
class Taker {
 public:
  Taker(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  bool isEmpty() const { return left_ == 0; }
  std::uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  template <class T>
  T number() {
    unsigned char bytes[sizeof(T)];
    for (unsigned char& b : bytes) b = byte();
    T value;
    __builtin_memcpy(&value, bytes, sizeof value);
    return value;
  }
  /// Between -2 and 2.
  double small() { return static_cast<double>(number<std::int16_t>()) / 16384; }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

}  // namespace otg::fuzz
