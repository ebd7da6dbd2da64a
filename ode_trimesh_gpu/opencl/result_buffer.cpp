// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/result_buffer.h"

#include <algorithm>

namespace otg::opencl {
namespace {

std::size_t recordSize(bool contacts) {
  return contacts ? sizeof(otg_contact_record) : sizeof(otg_pair_record);
}

}  // namespace

void ResultBuffer::read(Context& context, cl_command_queue queue, std::size_t bytes, Profile* profile) {
  host_.reserve(context, queue, bytes);
  readBlocking(queue, buffer_.get(), bytes, host_.data(), profile ? profile->next(Profile::kReadBack) : nullptr);
}

const otg_uint* ResultBuffer::readHead(Context& context, cl_command_queue queue, bool contacts, Profile* profile) {
  have_ = std::min(expected_, buffer_.places());
  read(context, queue, OTG_RESULT_HEAD + have_ * recordSize(contacts), profile);
  return reinterpret_cast<const otg_uint*>(host_.data());
}

Answer ResultBuffer::readRest(Context& context, cl_command_queue queue, bool contacts, Profile* profile) {
  const std::size_t size = recordSize(contacts);
  const std::uint32_t count = reinterpret_cast<const otg_uint*>(host_.data())[OTG_COUNT_HITS];
  if (count > have_) read(context, queue, OTG_RESULT_HEAD + count * size, profile);
  // The next query is likely to have about as many.
  expected_ = std::max(least_, count + count / 4);
  return {reinterpret_cast<const otg_uint*>(host_.data()), host_.data() + OTG_RESULT_HEAD, count, size};
}

}  // namespace otg::opencl
