// SPDX-License-Identifier: BSD-3-Clause
// Other collision libraries behind one interface, so that `otg bench peers` can time them side by side.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mesh/tri_mesh.h"

namespace otg::peers {

/// Two meshes and where the second one is. Must outlive the peers made from it.
struct PeerScene {
  const TriMesh* a = nullptr;
  const TriMesh* b = nullptr;
  Transformd bInA{};
};

/// A contact in A's frame: moving A along the normal (unit) by the depth separates, as far as the library is right.
struct PeerContact {
  Vec3d position, normal;
  double depth = 0;
};

/// One library with both meshes built. Everything that does not depend on the pose is done in the constructor.
class Peer {
 public:
  virtual ~Peer() = default;
  /// One query, from poses to contacts (or pairs). The results stay until the next one.
  virtual void query() = 0;
  /// Number of results of the last query.
  virtual std::size_t resultCount() const = 0;
  /// The results as plain numbers in the library's own order, for a hash.
  virtual std::vector<double> resultNumbers() const = 0;
  /// The results as contacts, whatever the library's own conventions are; empty for libraries that find pairs only.
  virtual std::vector<PeerContact> contacts() const { return {}; }
};

struct PeerEntry {
  std::string name;
  std::string unit;         ///< what resultCount counts
  std::string unavailable;  ///< why it is not there; empty when it is
  std::function<std::unique_ptr<Peer>(const PeerScene&)> make;
};

/// ODE and this library's geom class in ODE first, then what was found when the project was configured. ODE must be
/// initialised (scenes::OdeSession does that) while ODE peers live.
std::vector<PeerEntry> allPeers();

// The makers behind allPeers, one file each.
std::unique_ptr<Peer> makeStockOdePeer(const PeerScene& scene, int maxContacts);
/// `contactModel`: dGPUTRIMESH_CONTACTS_...
std::unique_ptr<Peer> makeGpuTriMeshPeer(const PeerScene& scene, int maxContacts, int contactModel);
std::unique_ptr<Peer> makeFclPeer(const PeerScene& scene);
std::unique_ptr<Peer> makeBulletPeer(const PeerScene& scene);
std::unique_ptr<Peer> makeEmbreePeer(const PeerScene& scene);

}  // namespace otg::peers
