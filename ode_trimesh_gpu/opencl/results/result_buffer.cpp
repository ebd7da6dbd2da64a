// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/results/result_buffer.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace otg::opencl {
namespace {

// Devices write contacts in the host's layout.
static_assert(sizeof(Contact) == sizeof(otg_chosen_contact) && std::is_trivially_copyable_v<Contact>);
static_assert(offsetof(Contact, normal) == offsetof(otg_chosen_contact, normal) &&
              offsetof(Contact, depth) == offsetof(otg_chosen_contact, depth) &&
              offsetof(Contact, triangleA) == offsetof(otg_chosen_contact, triangleA) &&
              offsetof(Contact, triangleB) == offsetof(otg_chosen_contact, triangleB) &&
              offsetof(Contact, region) == offsetof(otg_chosen_contact, region) &&
              offsetof(Contact, feature) == offsetof(otg_chosen_contact, feature) &&
              offsetof(Contact, element) == offsetof(otg_chosen_contact, element) &&
              offsetof(Contact, ordinal) == offsetof(otg_chosen_contact, ordinal) &&
              offsetof(Contact, coherence) == offsetof(otg_chosen_contact, coherence));
static_assert(static_cast<int>(ContactFeature::kFaceA) == OTG_RECORD_FACE_A &&
              static_cast<int>(ContactFeature::kFaceB) == OTG_RECORD_FACE_B &&
              static_cast<int>(ContactFeature::kCoplanar) == OTG_RECORD_COPLANAR);

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

Answer ResultBuffer::readAll(Context& context, cl_command_queue queue, bool contacts, const otg_uint* counters,
                             Profile* profile) {
  return readSome(context, queue, contacts, counters, counters[OTG_COUNT_HITS], profile);
}

Answer ResultBuffer::readSome(Context& context, cl_command_queue queue, bool contacts, const otg_uint* counters,
                              std::uint32_t count, Profile* profile) {
  read(context, queue, OTG_RESULT_HEAD + count * recordSize(contacts), profile);
  return {counters, host_.data() + OTG_RESULT_HEAD, count, recordSize(contacts)};
}

void ChosenBuffer::reserve(Context& context, std::uint32_t pairs, std::uint32_t contacts) {
  const std::uint64_t bytes = OTG_RESULT_CONTACTS(std::uint64_t{pairs}) + contacts * sizeof(Contact);
  buffer_.reserve(context, bytes);
  contactPlaces_ = contacts;
}

void ChosenBuffer::makeRoom(Context& context, std::size_t bytes) {
  if (!host_ || host_.use_count() > 1) host_ = pool_->take();
  host_->reserve(context, pool_->queue(), bytes);
}

void ChosenBuffer::read(Context& context, cl_command_queue queue, std::size_t bytes, Profile* profile) {
  if (answers_ && endAnswer(queue)) return;
  makeRoom(context, bytes);
  readBlocking(queue, answers_ ? answer_.get() : buffer_.get(), bytes, host_->data(),
               profile ? profile->next(Profile::kReadBack) : nullptr);
  head_ = host_->data();
}

BufferOf<otg_chosen_word> ChosenBuffer::beginAnswer(Context& context, cl_command_queue queue, std::uint32_t mode) {
  answers_ = !blind_ && (mode >= 2 || (mode == 1 && context.hostBuffers()));
  answerMode_ = mode;
  if (!answers_) return words();
  answer_.reserve(context, queue, OTG_RESULT_CONTACTS(std::size_t{1}) + contactPlaces_ * sizeof(Contact), true);
  // Flags that no kernel writes, to see that one did.
  constexpr otg_uint kNothing = ~0u;
  std::memcpy(answer_.data() + OTG_RESULT_HEAD, &kNothing, sizeof kNothing);
  return BufferOf<otg_chosen_word>(answer_.get());
}

/// Waits for the queue. False if the host does not see what the last kernel wrote: it has to be read then, and from now
/// on all results are.
bool ChosenBuffer::endAnswer(cl_command_queue queue) {
  clDo(OTG_CL(clFinish), queue);
  otg_uint flags = 0;
  std::memcpy(&flags, answer_.data() + OTG_RESULT_HEAD, sizeof flags);
  if (flags != ~0u && answerMode_ != 3) {
    head_ = answer_.data();
    have_ = contactPlaces_;
    return true;
  }
  blind_ = true;
  return false;
}

std::size_t ChosenBuffer::headBytes(std::uint32_t pairs, bool contacts) {
  pairs_ = pairs;
  have_ = contacts ? std::min(expected_, contactPlaces_) : 0;
  return contacts ? OTG_RESULT_CONTACTS(std::size_t{pairs}) + have_ * sizeof(Contact)
                  : OTG_RESULT_HEAD + pairs * sizeof(otg_uint);
}

const otg_uint* ChosenBuffer::readHead(Context& context, cl_command_queue queue, std::uint32_t pairs, bool contacts,
                                       Profile* profile) {
  read(context, queue, headBytes(pairs, contacts), profile);
  return counters();
}

void ChosenBuffer::beginHead(Context& context, cl_command_queue queue, std::uint32_t pairs, bool contacts,
                             Profile* profile) {
  const std::size_t bytes = headBytes(pairs, contacts);
  makeRoom(context, bytes);
  clDo(OTG_CL(clEnqueueReadBuffer), queue, buffer_.get(), cl_bool{CL_FALSE}, std::size_t{0}, bytes,
       static_cast<void*>(host_->data()), cl_uint{0}, static_cast<const cl_event*>(nullptr),
       profile->next(Profile::kReadBack));
  clDo(OTG_CL(clFlush), queue);
}

const otg_uint* ChosenBuffer::endHead(cl_command_queue queue) {
  clDo(OTG_CL(clFinish), queue);
  head_ = host_->data();
  return counters();
}

std::span<const Contact> ChosenBuffer::readRest(Context& context, cl_command_queue queue, std::uint32_t count,
                                                Profile* profile) {
  const std::size_t begin = OTG_RESULT_CONTACTS(std::size_t{pairs_});
  if (count > have_) read(context, queue, begin + count * sizeof(Contact), profile);
  expected_ = std::max(64u, count + count / 8);
  return {reinterpret_cast<const Contact*>(head_ + begin), count};
}

}  // namespace otg::opencl
