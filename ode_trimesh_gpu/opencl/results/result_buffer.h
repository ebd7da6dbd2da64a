// SPDX-License-Identifier: BSD-3-Clause
// The way of results back to the host: a head with the counters and what follows it, read at once as far as can be
// foreseen.
#pragma once

#include <cstddef>
#include <cstdint>

#include "collide/query.h"
#include "opencl/runtime/given.h"
#include "opencl/runtime/pinned_buffer.h"
#include "shared/layout/elements.h"

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

/// Records of hits behind a head.
class ResultBuffer {
 public:
  /// Reads `expected` records in the first query.
  explicit ResultBuffer(std::uint32_t expected) : least_(expected), expected_(expected) {}

  void reserve(Context& context, std::uint32_t records) { buffer_.reserve(context, records, OTG_RESULT_HEAD); }
  cl_mem get() const { return buffer_.get(); }
  BufferOf<otg_result_byte> bytes() const { return BufferOf<otg_result_byte>(get()); }
  std::uint32_t places() const { return buffer_.places(); }

  /// Waits for the queue and reads the head and the expected number of records; the counters.
  const otg_uint* readHead(Context& context, cl_command_queue queue, bool contacts, Profile* profile = nullptr);
  /// After readHead: the records that were not read yet, if any.
  Answer readRest(Context& context, cl_command_queue queue, bool contacts, Profile* profile = nullptr);
  /// All records where no kernel wrote the head: so many as these counters say,
  Answer readAll(Context& context, cl_command_queue queue, bool contacts, const otg_uint* counters,
                 Profile* profile = nullptr);
  /// or so many.
  Answer readSome(Context& context, cl_command_queue queue, bool contacts, const otg_uint* counters,
                  std::uint32_t count, Profile* profile = nullptr);

 private:
  void read(Context& context, cl_command_queue queue, std::size_t bytes, Profile* profile);
  DeviceList buffer_{sizeof(otg_contact_record)};
  PinnedBuffer host_;
  std::uint32_t least_, expected_, have_ = 0;
};

/// Chosen contacts behind a head, a flag for each pair, and place and number of their contacts.
class ChosenBuffer {
 public:
  /// Reads into buffers of `pool`.
  explicit ChosenBuffer(std::shared_ptr<PinnedPool> pool) : pool_(std::move(pool)) {}
  void reserve(Context& context, std::uint32_t pairs, std::uint32_t contacts);
  cl_mem get() const { return buffer_.get(); }
  BufferOf<otg_chosen_word> words() const { return BufferOf<otg_chosen_word>(get()); }

  /// For one pair: `mode` as Tuning::hostAnswers. Before the last kernel of a query is enqueued: where it has to write,
  /// which is words() or host memory; readHead() finds it there.
  BufferOf<otg_chosen_word> beginAnswer(Context& context, cl_command_queue queue, std::uint32_t mode);
  std::uint32_t contactPlaces() const { return contactPlaces_; }

  /// Waits for the queue and reads the head, what belongs to each pair, and as many contacts as were there last time.
  const otg_uint* readHead(Context& context, cl_command_queue queue, std::uint32_t pairs, bool contacts,
                           Profile* profile = nullptr);
  /// The same in two steps: begins to read behind what is in the queue,
  void beginHead(Context& context, cl_command_queue queue, std::uint32_t pairs, bool contacts, Profile* profile);
  /// and waits for the queue.
  const otg_uint* endHead(cl_command_queue queue);
  /// After readHead: the contacts that were not read yet, if any. `count` is at most contactPlaces().
  std::span<const Contact> readRest(Context& context, cl_command_queue queue, std::uint32_t count,
                                    Profile* profile = nullptr);
  const otg_uint* counters() const { return reinterpret_cast<const otg_uint*>(head_); }
  const otg_uint* flags() const { return counters() + OTG_FLAGS; }
  /// Two words a pair: place and number of its contacts.
  const otg_uint* places() const { return flags() + pairs_; }
  /// What all that lies in; the next query leaves it alone as long as it is shared.
  std::shared_ptr<const void> memory() const { return host_; }

 private:
  bool endAnswer(cl_command_queue queue);
  void makeRoom(Context& context, std::size_t bytes);
  std::size_t headBytes(std::uint32_t pairs, bool contacts);
  void read(Context& context, cl_command_queue queue, std::size_t bytes, Profile* profile);
  const std::shared_ptr<PinnedPool> pool_;
  PinnedBuffer answer_;  // where kernels write to directly
  bool answers_ = false, blind_ = false;
  std::uint32_t answerMode_ = 0;
  DeviceList buffer_{1};
  std::shared_ptr<PinnedBuffer> host_;
  const std::byte* head_ = nullptr;  // of host_ or answer_
  std::uint32_t pairs_ = 0, contactPlaces_ = 0, expected_ = 64, have_ = 0;
};

}  // namespace otg::opencl
