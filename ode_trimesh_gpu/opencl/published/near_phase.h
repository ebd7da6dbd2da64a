// SPDX-License-Identifier: BSD-3-Clause
// How the near phase alone is requested, and what is known of it afterwards. Free of OpenCL's types.
#pragma once

#include <cstdint>

namespace otg::opencl {

/// What the device does of each candidate pair of triangles.
enum class NearOrder {
  kContactsFirst,  ///< as published: a contact without a test; pairs that do not meet are seen from the result
  kFilterFirst     ///< the float filter; a contact for what it leaves
};

/// Milliseconds. Those from `upload` to `readBack` are the device's clock.
struct NearTimes {
  double gather = 0;    ///< triangles that candidates name, brought together by the CPU
  double upload = 0;    ///< these, and the pairs
  double kernel = 0;    ///< tests and contacts
  double readBack = 0;  ///< records
  double host = 0;      ///< what the device left open; records sorted, regions
  double total = 0;     ///< from call to return
};

struct NearReport {
  std::uint64_t candidates = 0, triangles = 0;  ///< pairs that were sent, and triangles that they name
  std::uint64_t records = 0;                    ///< that came back
  std::uint64_t bytesSent = 0;
  NearTimes times;  ///< if they were requested
};

}  // namespace otg::opencl
