// SPDX-License-Identifier: BSD-3-Clause
// Contacts where one of two meshes is a shell: neither closed nor a solid. docs/contacts.md states the rule.
#pragma once

#include <vector>

#include "collide/query.h"
#include "collide/shell/ground_sides.h"

namespace otg {

/// Memory that is kept from query to query.
struct ShellScratch {
  GroundSides sides;
  std::vector<TrianglePair> distinct;  ///< without copies of triangles
  std::vector<TrianglePair> pairs;     ///< visitor's triangle and ground's, ascending
  std::vector<Contact> contacts;       ///< A stands for the visitor and B for the ground, in whose frame they are
  EpochArray seen;                     ///< by vertex of the visitor
  struct Candidate {
    std::uint32_t vertex, hint;
  };
  std::vector<Candidate> candidates;
  std::vector<double> crossings;
};

/// workspace.intersecting -> workspace.contacts and workspace.reduced, in the meshes' own numbers. Reads and writes
/// query.history.
void shellContacts(const Query& query, Workspace& workspace);

}  // namespace otg
