// SPDX-License-Identifier: BSD-3-Clause
// The list of peers. OTG_PEER_... say which libraries were found at configure time.
#include "peers/peer.h"

#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

namespace otg::peers {
namespace {

/// ODE keeps the capacity in 16 bits.
constexpr int kAllContacts = 65535;

}  // namespace

std::vector<PeerEntry> allPeers() {
  std::vector<PeerEntry> peers;
  const auto contacts = [](int count) { return [count](const PeerScene& s) { return makeStockOdePeer(s, count); }; };
  peers.push_back({"ODE dTriMesh, 64 contacts", "contacts", "", contacts(64)});
  peers.push_back({"ODE dTriMesh, all contacts", "contacts", "", contacts(kAllContacts)});
  const auto ours = [](int model) { return [model](const PeerScene& s) { return makeGpuTriMeshPeer(s, 64, model); }; };
  peers.push_back(
      {"ODE with ode_trimesh_gpu, pairwise, 64 contacts", "contacts", "", ours(dGPUTRIMESH_CONTACTS_PAIRWISE)});
  peers.push_back({"ODE with ode_trimesh_gpu, solid, 64 contacts", "contacts", "", ours(dGPUTRIMESH_CONTACTS_SOLID)});
#ifdef OTG_PEER_FCL
  peers.push_back({"FCL, OBB tree", "contacts", "", &makeFclPeer});
#else
  peers.push_back({"FCL, OBB tree", "contacts", "not found at configure time (libfcl-dev)", {}});
#endif
#ifdef OTG_PEER_BULLET
  peers.push_back({"Bullet, GImpact", "contacts", "", &makeBulletPeer});
#else
  peers.push_back({"Bullet, GImpact", "contacts", "not found at configure time (libbullet-dev)", {}});
#endif
#ifdef OTG_PEER_EMBREE
  peers.push_back({"Embree, pairs only, B built in A's frame", "pairs", "", &makeEmbreePeer});
#else
  peers.push_back(
      {"Embree, pairs only, B built in A's frame", "pairs", "not found at configure time (libembree-dev)", {}});
#endif
  return peers;
}

}  // namespace otg::peers
