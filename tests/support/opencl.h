// SPDX-License-Identifier: BSD-3-Clause
// What tests of the OpenCL backend share.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "opencl/backend.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/contact_samples.h"
#include "support/draw.h"
#include "support/make_query.h"

namespace otg::test {

inline std::shared_ptr<opencl::Backend> openBackend(const opencl::Tuning& tuning = {}) {
  return opencl::Backend::open(opencl::defaultDevice(opencl::listDevices()), tuning);
}

inline std::shared_ptr<const CollisionMesh> collisionMesh(const scenes::MeshArrays& arrays) {
  return std::make_shared<CollisionMesh>(scenes::build(arrays), BuildStrategy::kSah);
}

/// To the last bit, the signs of zeros included.
inline bool sameBytes(std::span<const Contact> x, std::span<const Contact> y) {
  const auto bits = [](const Contact& c) {
    return std::make_tuple(std::bit_cast<std::array<std::uint64_t, 3>>(c.position),
                           std::bit_cast<std::array<std::uint64_t, 3>>(c.normal), std::bit_cast<std::uint64_t>(c.depth),
                           c.triangleA, c.triangleB, c.region, c.feature, c.flags, c.element, c.ordinal,
                           std::bit_cast<std::uint64_t>(c.coherence));
  };
  return std::equal(x.begin(), x.end(), y.begin(), y.end(),
                    [&](const Contact& a, const Contact& b) { return bits(a) == bits(b); });
}

/// What the device gives is what the host gives, in the same order and byte for byte. For that its doubles must round
/// as the host's, which Backend requests of a device. With `allStages` pairs and contacts before reduction too, which
/// are there where the host reduces.
inline void checkSame(const Workspace& device, const Workspace& host, bool allStages = false) {
  if (allStages) {
    CHECK((device.intersecting == host.intersecting));
    CHECK(sameBytes(device.contacts, host.contacts));
  }
  CHECK(sameBytes(device.reduced, host.reduced));
  CHECK(device.stats.intersectingPairs == host.stats.intersectingPairs);
  CHECK(device.stats.contactsBeforeReduction == host.stats.contactsBeforeReduction);
}

/// Runs the query on both; checks that the device did it and that the answers are the same.
inline void checkParity(opencl::Backend& backend, const Query& query, bool allStages = false) {
  Workspace device, host;
  CHECK(backend.collide(query, device));
  collide(query, host);
  checkSame(device, host, allStages);
}

}  // namespace otg::test
