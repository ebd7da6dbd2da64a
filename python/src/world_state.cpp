// SPDX-License-Identifier: BSD-3-Clause
#include "world_state.h"

#include <algorithm>
#include <cstring>

#include "base/hash.h"
#include "errors.h"

namespace otg::python {
namespace {

constexpr char kMark[8] = {'O', 'T', 'G', 'W', 'R', 'L', 'D', '1'};

struct Head {
  char mark[8];
  std::uint64_t checksum, bodies, historyBytes, randomState;
  std::int64_t steps;
  double time;
};

/// Of a moving body all of ODE's own numbers; of a static one its pose.
struct BodyRecord {
  double position[4], quaternion[4], rotation[12], linear[4], angular[4], force[4], torque[4];
  double pose[16];
  std::uint64_t moves;
};

BodyRecord recordOf(const World::Body& body) {
  BodyRecord record = {};
  std::copy(body.pose.begin(), body.pose.end(), record.pose);
  record.moves = body.body != nullptr ? 1 : 0;
  if (body.body == nullptr) return record;
  const auto copy = [](const dReal* from, std::size_t count, double* to) { std::copy(from, from + count, to); };
  copy(dBodyGetPosition(body.body), 3, record.position);
  copy(dBodyGetQuaternion(body.body), 4, record.quaternion);
  copy(dBodyGetRotation(body.body), 12, record.rotation);
  copy(dBodyGetLinearVel(body.body), 3, record.linear);
  copy(dBodyGetAngularVel(body.body), 3, record.angular);
  copy(dBodyGetForce(body.body), 3, record.force);
  copy(dBodyGetTorque(body.body), 3, record.torque);
  return record;
}

void restore(const BodyRecord& record, dBodyID body) {
  dBodySetPosition(body, record.position[0], record.position[1], record.position[2]);
  dBodySetQuaternion(body, record.quaternion);
  // ODE normalises what it is given, which may change the last bit. These two functions return its own numbers.
  std::copy(record.quaternion, record.quaternion + 4, const_cast<dReal*>(dBodyGetQuaternion(body)));
  std::copy(record.rotation, record.rotation + 12, const_cast<dReal*>(dBodyGetRotation(body)));
  dBodySetLinearVel(body, record.linear[0], record.linear[1], record.linear[2]);
  dBodySetAngularVel(body, record.angular[0], record.angular[1], record.angular[2]);
  dBodySetForce(body, record.force[0], record.force[1], record.force[2]);
  dBodySetTorque(body, record.torque[0], record.torque[1], record.torque[2]);
}

std::uint64_t checksumOf(const std::string& bytes) {
  constexpr std::size_t behind = offsetof(Head, checksum) + sizeof(std::uint64_t);
  return fnv1a(bytes.data() + behind, bytes.size() - behind, kFnvStart);
}

}  // namespace

nb::bytes saveState(World& world) {
  const OneAtATime alone(world.busy());
  const std::vector<dGeomID> geoms = world.geomIds();
  const int count = static_cast<int>(geoms.size());
  const std::size_t historyBytes = dGpuTriMeshHistorySave(geoms.data(), count, nullptr, 0);
  if (historyBytes == 0) failWithLastError();
  Head head = {};
  std::copy(std::begin(kMark), std::end(kMark), head.mark);
  head.bodies = world.bodies().size();
  head.historyBytes = historyBytes;
  head.randomState = world.randomState;
  head.steps = world.steps;
  head.time = world.time;
  std::string bytes(sizeof head, '\0');
  for (const World::Body& body : world.bodies()) {
    const BodyRecord record = recordOf(body);
    bytes.append(reinterpret_cast<const char*>(&record), sizeof record);
  }
  const std::size_t at = bytes.size();
  bytes.resize(at + historyBytes);
  dGpuTriMeshHistorySave(geoms.data(), count, bytes.data() + at, historyBytes);
  std::memcpy(bytes.data(), &head, sizeof head);
  head.checksum = checksumOf(bytes);
  std::memcpy(bytes.data(), &head, sizeof head);
  return nb::bytes(bytes.data(), bytes.size());
}

void loadState(World& world, const nb::bytes& given) {
  const OneAtATime alone(world.busy());
  const std::string bytes(given.c_str(), given.size());
  Head head;
  if (bytes.size() < sizeof head) throw ArgumentError("these bytes are no state of a world");
  std::memcpy(&head, bytes.data(), sizeof head);
  if (!std::equal(std::begin(kMark), std::end(kMark), head.mark) || head.checksum != checksumOf(bytes)) {
    throw ArgumentError("these bytes are no state of a world, or are damaged");
  }
  const std::size_t count = world.bodies().size();
  bool fits = head.bodies == count && bytes.size() == sizeof head + count * sizeof(BodyRecord) + head.historyBytes;
  std::vector<BodyRecord> records(fits ? count : 0);
  for (std::size_t i = 0; i < records.size(); ++i) {
    std::memcpy(&records[i], bytes.data() + sizeof head + i * sizeof(BodyRecord), sizeof(BodyRecord));
    fits = fits && (records[i].moves != 0) == (world.bodies()[i].body != nullptr);
  }
  if (!fits) throw ArgumentError("the state is that of a world with other bodies");
  const std::vector<dGeomID> geoms = world.geomIds();
  check(dGpuTriMeshHistoryLoad(geoms.data(), static_cast<int>(geoms.size()),
                               bytes.data() + bytes.size() - head.historyBytes, head.historyBytes),
        "the state");
  for (std::size_t i = 0; i < count; ++i) {
    if (records[i].moves == 0) {
      world.setPose(static_cast<int>(i), records[i].pose);
    } else {
      restore(records[i], world.bodies()[i].body);
    }
  }
  world.randomState = head.randomState;
  world.steps = head.steps;
  world.time = head.time;
  world.contacts().clear();
}

}  // namespace otg::python
