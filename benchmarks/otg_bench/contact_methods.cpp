// SPDX-License-Identifier: BSD-3-Clause
// Contacts of this library and of others, in one form.
#include <memory>

#include "collide/query.h"
#include "otg_bench/contacts.h"
#include "peers/peer.h"

namespace otg::cli {
namespace {

std::vector<truth::PlainContact> own(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA,
                                     const CollideOptions& options) {
  static Workspace workspace;
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = bInA;
  query.options = options;
  collide(query, workspace);
  return truth::plain(workspace.reduced);
}

void addPeer(std::vector<ContactMethod>& methods, const std::string& entryName, const std::string& name) {
  for (const peers::PeerEntry& entry : peers::allPeers()) {
    if (entry.name != entryName || !entry.make) continue;
    methods.push_back(
        {name, [make = entry.make](const CollisionMesh& a, const CollisionMesh& b, const Transformd& pose) {
           const std::unique_ptr<peers::Peer> peer = make({&a.mesh(), &b.mesh(), pose});
           peer->query();
           std::vector<truth::PlainContact> contacts;
           for (const peers::PeerContact& c : peer->contacts()) {
             contacts.push_back({c.position, c.normal, c.depth});
           }
           return contacts;
         }});
  }
}

}  // namespace

std::vector<truth::PlainContact> solidContactsOf(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA,
                                                 int maxContacts) {
  CollideOptions options;
  options.contacts = ContactModel::kSolid;
  options.maxContacts = maxContacts > 0 ? maxContacts : 65535;
  if (maxContacts == 0) options.solid.contactsPerRegion = 1 << 20;
  return own(a, b, bInA, options);
}

std::vector<ContactMethod> contactMethods() {
  std::vector<ContactMethod> methods;
  for (const int places : {64, 8}) {
    methods.push_back({"solid, " + std::to_string(places),
                       [places](const CollisionMesh& a, const CollisionMesh& b, const Transformd& pose) {
                         return solidContactsOf(a, b, pose, places);
                       }});
  }
  methods.push_back({"pairwise, 64", [](const CollisionMesh& a, const CollisionMesh& b, const Transformd& pose) {
                       return own(a, b, pose, CollideOptions{});
                     }});
  addPeer(methods, "ODE dTriMesh, 64 contacts", "ODE dTriMesh, 64");
  addPeer(methods, "FCL, OBB tree", "FCL, all");
  addPeer(methods, "Bullet, GImpact", "Bullet, all");
  return methods;
}

}  // namespace otg::cli
