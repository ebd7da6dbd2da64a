// SPDX-License-Identifier: BSD-3-Clause
// The nearest triangles of many pairs on the device.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "opencl/backend.h"
#include "opencl/backend_state.h"
#include "opencl/batch/batch_source.h"

namespace otg::opencl {
namespace {

constexpr std::size_t kMostWaits = 2000;  ///< for memory, a millisecond each

/// What the device needs to know of a pair but for its meshes. False if the CPU has to do it.
bool fillDistance(const Query& query, double limit, otg_distance_task& task) {
  const PairFrame frame = makePairFrame(query);
  std::copy(std::begin(query.bInA.r), std::end(query.bInA.r), task.r);
  task.t[0] = query.bInA.t.x;
  task.t[1] = query.bInA.t.y;
  task.t[2] = query.bInA.t.z;
  task.boxes = deviceBoxes(frame);
  // Three gaps together are off by less than twice what one may be (PairBounds), which is many times what distances of
  // triangles may be.
  task.boxes.eps *= 4;
  const Vec3f& t = task.boxes.t;
  const double reach = std::sqrt(double{t.x} * t.x + double{t.y} * t.y + double{t.z} * t.z) +
                       double{query.a->mesh().radius()} + double{query.b->mesh().radius()};
  const bool isOfUse = frame.finite && reach > OTG_DISTANCE_LEAST && reach < OTG_DISTANCE_MOST;
  task.limit = isOfUse ? limit : -1;
  return isOfUse;
}

/// How many of the queries are for one launch: `most` at most, and no more work, in microseconds as of an H200, than
/// `work`. Measured there with pairs of 640 to 692,000 triangles that are apart: a pair takes 1 to 11 microseconds.
std::size_t countForLaunch(std::span<const Query> queries, std::size_t most, double work) {
  std::size_t count = 0;
  for (double sum = 0; count < std::min(most, queries.size()); ++count) {
    const TriMesh &a = queries[count].a->mesh(), &b = queries[count].b->mesh();
    sum += 1 + 0.013 * std::sqrt(static_cast<double>(a.triangleCount() + b.triangleCount()));
    if (count > 0 && sum > work) break;
  }
  return count;
}

}  // namespace

std::size_t Backend::nearestTriangles(std::span<const Query> queries, double limit, std::span<TrianglePair> answers,
                                      const RunParts& run) {
  state_->distancesAsked += queries.size();
  std::size_t done = 0, most = std::max(1u, state_->tuning.distancePairs), waits = 0;
  while (done < queries.size()) {
    const std::size_t count = countForLaunch(queries.subspan(done), most, state_->tuning.distanceWork);
    const std::span<const Query> some = queries.subspan(done, count);
    try {
      state_->distances.with([&](DistanceLane& lane) {
        const std::span<otg_distance_task> tasks = lane.stage(some.size());
        std::vector<const CollisionMesh*> meshes;
        MeshNumbers numbers(meshes);
        for (std::size_t i = 0; i < some.size(); ++i) {
          tasks[i].meshA = numbers(some[i].a);
          tasks[i].meshB = numbers(some[i].b);
        }
        std::vector<std::uint8_t> isHosts(some.size());
        run(some.size(), [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) isHosts[i] = fillDistance(some[i], limit, tasks[i]) ? 0 : 1;
        });
        const std::span<const otg_uint> words = lane.run(meshes, run);
        static_assert(OTG_DISTANCE_NOTHING == kNone);
        for (std::size_t i = 0; i < some.size(); ++i) {
          answers[done + i] = isHosts[i] ? kLeftToHost : TrianglePair{words[2 * i], words[2 * i + 1]};
        }
      });
      done += some.size();
    } catch (const ClError& error) {
      // Perhaps their meshes do not fit at once.
      if (error.code() == CL_MEM_OBJECT_ALLOCATION_FAILURE && some.size() > 1) {
        most = (some.size() + 1) / 2;
        continue;
      }
      // This call holds no meshes now; others that do are done soon.
      if (dynamic_cast<const MemoryInUse*>(&error) != nullptr && waits < kMostWaits) {
        ++waits;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        continue;
      }
      logError(error);
      state_->distancesOnHost += queries.size() - done;
      break;
    }
  }
  return done;
}

}  // namespace otg::opencl
