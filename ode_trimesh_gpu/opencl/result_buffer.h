// SPDX-License-Identifier: BSD-3-Clause
// The way of results back to the host: a head with the counters and one record for each hit, read at once as far as can
// be foreseen.
#pragma once

#include <cstddef>
#include <cstdint>

#include "opencl/launch.h"
#include "opencl/pinned_buffer.h"
#include "shared/device_layout.h"

namespace otg::opencl {

/// Views of the buffer's memory on the host, good until it is read again.
struct Answer {
  const otg_uint* counters = nullptr;
  const std::byte* records = nullptr;
  std::uint32_t count = 0;
  std::size_t recordSize = 0;  ///< of otg_contact_record or otg_pair_record
  std::uint64_t count64(int counter) const { return counters[counter] | std::uint64_t{counters[counter + 1]} << 32; }
  bool hasContacts() const { return recordSize == sizeof(otg_contact_record); }
};

class ResultBuffer {
 public:
  /// Reads `expected` records in the first query.
  explicit ResultBuffer(std::uint32_t expected) : least_(expected), expected_(expected) {}

  void reserve(Context& context, std::uint32_t records) { buffer_.reserve(context, records, OTG_RESULT_HEAD); }
  cl_mem get() const { return buffer_.get(); }

  /// Waits for the queue and reads the head and the expected number of records; the counters.
  const otg_uint* readHead(Context& context, cl_command_queue queue, bool contacts, Profile* profile = nullptr);
  /// After readHead: the records that were not read yet, if any.
  Answer readRest(Context& context, cl_command_queue queue, bool contacts, Profile* profile = nullptr);

 private:
  void read(Context& context, cl_command_queue queue, std::size_t bytes, Profile* profile);
  DeviceList buffer_{sizeof(otg_contact_record)};
  PinnedBuffer host_;
  std::uint32_t least_, expected_, have_ = 0;
};

}  // namespace otg::opencl
