// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/published/near_lane.h"

#include <algorithm>
#include <bit>
#include <string>

#include "opencl/meshes/packed_mesh.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/stopwatch.h"

namespace otg::opencl {
namespace {

constexpr std::size_t kNearGroup = 64;

}  // namespace

void GatheredTriangles::Places::begin(std::size_t triangles) {
  if (of.size() < triangles) of.resize(triangles, kNone);
  taken.clear();
}

std::uint32_t GatheredTriangles::Places::take(std::uint32_t triangle) {
  if (of[triangle] == kNone) {
    of[triangle] = static_cast<std::uint32_t>(taken.size());
    taken.push_back(triangle);
  }
  return of[triangle];
}

void GatheredTriangles::Places::append(const TriMesh& mesh, std::vector<otg_mesh_unit>& units) {
  for (const std::uint32_t triangle : taken) {
    for (std::uint32_t k = 0; k < 3; ++k) units.push_back(triangleCorner(mesh, triangle, k));
    of[triangle] = kNone;
  }
}

void GatheredTriangles::gather(const Query& query, std::span<const TrianglePair> candidates) {
  const TriMesh &a = query.a->mesh(), &b = query.b->mesh();
  a_.begin(a.triangleCount());
  b_.begin(b.triangleCount());
  pairs_.clear();
  pairs_.reserve(candidates.size());
  for (const TrianglePair& pair : candidates) {
    if (!a.isDegenerate(pair.a) && !b.isDegenerate(pair.b)) pairs_.push_back({a_.take(pair.a), b_.take(pair.b)});
  }
  countA_ = static_cast<std::uint32_t>(a_.taken.size());
  units_.clear();
  units_.reserve(3 * (a_.taken.size() + b_.taken.size()));
  a_.append(a, units_);
  b_.append(b, units_);
}

NearLane::NearLane(Context& context, MeshStore&, const Tuning& tuning)
    : context_(context),
      group_(std::min<std::size_t>(kNearGroup, context.info().largestWorkGroup)),
      groups_(std::max<std::size_t>(1, std::size_t{context.info().computeUnits} * tuning.groupsPerUnit)),
      doubles_(context.info().doubles),
      queue_(context.makeQueue(tuning.profile)),
      results_(tuning.recordsExpected),
      profile_(tuning.profile),
      hitPlaces_(tuning.hitPlaces) {
  counters_.reserve(context, OTG_COUNTERS);
  fillZero(queue_.get(), counters_.get(), OTG_COUNTERS * sizeof(otg_uint));
}

NearLane::Kernels& NearLane::kernels(bool contacts) {
  Kernels& made = kernels_[contacts ? 1 : 0];
  if (made.end) return made;
  const std::string options = "-DOTG_GROUP=" + std::to_string(group_) + " -DOTG_CONTACTS=" + (contacts ? "1" : "0");
  const std::string filter = options + " -DOTG_LEAF=1 -DOTG_FUSED=1 -DOTG_ENTER=0";
  if (doubles_) made.contactsFirst.make(context_, "published/contacts_first.cl", options);
  made.filterFirst.make(context_, "published/levels_near.cl", filter);
  made.end.make(context_, "published/levels_near.cl", filter);
  return made;
}

Answer NearLane::run(const Query& query, const PairFrame& frame, std::span<const TrianglePair> candidates,
                     NearOrder order, bool contacts) {
  const bool makes = contacts && doubles_;
  report_ = {};
  const Stopwatch gathering(profile_.on());
  gathered_.gather(query, candidates);
  report_.times.gather = gathering.ms();
  static constexpr otg_uint kNothing[OTG_COUNTERS] = {};
  Answer answer;
  answer.counters = kNothing;
  answer.recordSize = makes ? sizeof(otg_contact_record) : sizeof(otg_pair_record);
  if (gathered_.pairs().empty()) return answer;
  try {
    otg_device_pair pair{deviceBoxes(frame), frame.floatError, {}, {}};
    pair.a.center = query.a->mesh().origin();
    pair.b.center = query.b->mesh().origin();
    pair.b.soup = 3 * gathered_.countA();
    send();
    for (;; ++repeats_) {
      results_.reserve(context_, hitPlaces_);
      enqueue(pair, query, doubles_ ? order : NearOrder::kFilterFirst, makes);
      const otg_uint* counters = results_.readHead(context_, queue_.get(), makes, &profile_);
      if (counters[OTG_COUNT_HITS] <= hitPlaces_) break;
      hitPlaces_ = std::bit_ceil(counters[OTG_COUNT_HITS]);
    }
    answer = results_.readRest(context_, queue_.get(), makes, &profile_);
  } catch (...) {
    // What is sent may still be read.
    clRelease(OTG_CL(clFinish), queue_.get());
    throw;
  }
  report_.records = answer.count;
  if (profile_.on()) profile_.collect();
  report_.times.upload = profile_.ms(Profile::kWrite);
  report_.times.kernel = profile_.ms(Profile::kNear);
  report_.times.readBack = profile_.ms(Profile::kReadBack);
  return answer;
}

/// Does not wait.
void NearLane::send() {
  const std::vector<otg_mesh_unit>& units = gathered_.units();
  const std::vector<otg_place_pair>& pairs = gathered_.pairs();
  const std::size_t unitBytes = units.size() * sizeof units[0], pairBytes = pairs.size() * sizeof pairs[0];
  triangles_.reserve(context_, std::bit_ceil(units.size()));
  pairs_.reserve(context_, std::bit_ceil(pairs.size()));
  writeLater(queue_.get(), triangles_.get(), unitBytes, units.data(), profile_.next(Profile::kWrite));
  writeLater(queue_.get(), pairs_.get(), pairBytes, pairs.data(), profile_.next(Profile::kWrite));
  report_.candidates = pairs.size();
  report_.triangles = units.size() / 3;
  report_.bytesSent = unitBytes + pairBytes;
}

void NearLane::enqueue(const otg_device_pair& pair, const Query& query, NearOrder order, bool contacts) {
  Kernels& made = kernels(contacts);
  const auto count = static_cast<otg_uint>(gathered_.pairs().size());
  const std::size_t groups = (count + group_ - 1) / group_;
  if (order == NearOrder::kContactsFirst) {
    made.contactsFirst.give({.pair = pair,
                             .bInA = query.bInA,
                             .meshes = triangles_.buffer(),
                             .counters = counters_.buffer(),
                             .candidates = pairs_.buffer(),
                             .count = count,
                             .hitCapacity = hitPlaces_,
                             .results = results_.bytes()});
    launch(queue_.get(), made.contactsFirst, group_, groups, 1, profile_.next(Profile::kNear));
  } else {
    made.filterFirst.give({.pair = pair,
                           .bInA = query.bInA,
                           .meshes = triangles_.buffer(),
                           .counters = counters_.buffer(),
                           .leaves = pairs_.buffer(),
                           .count = count,
                           .hitCapacity = hitPlaces_,
                           .results = results_.bytes()});
    launch(queue_.get(), made.filterFirst, group_, groups, 1, profile_.next(Profile::kNear));
  }
  made.end.give({.counters = counters_.buffer(), .results = results_.bytes()});
  launch(queue_.get(), made.end, group_, groups_, 1, profile_.next(Profile::kNear));
}

}  // namespace otg::opencl
