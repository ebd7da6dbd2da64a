// SPDX-License-Identifier: BSD-3-Clause
// Parts of the stages on the CPU that other backends use to finish what they began.
#pragma once

#include <span>
#include <vector>

#include "collide/pair_frame.h"
#include "collide/query.h"

namespace otg {

/// The exact result for one pair of triangles that are not degenerate in their own meshes: the double filter, then
/// exact arithmetic. Counts both. False where B's triangle has no area in A's frame.
bool decidePair(const Query& query, const PairFrame& frame, const TrianglePair& pair, CollideStats& stats);

/// The published contact of one intersecting pair, with region 0. False if the pair has none.
bool contactOfPair(const Query& query, const TrianglePair& pair, Contact& contact);

/// The feature of a contact of one of the kinds of pairwise_contact.h.
ContactFeature featureOf(int contactKind);

/// Whether the contacts of the query are those of `pairwise`. If not, they are those of solids or of shells.
bool isPairwise(const Query& query);

/// Everything after the narrow phase: workspace.intersecting -> workspace.reduced, with the meshes' own triangle
/// numbers.
void collideIntersecting(const Query& query, Workspace& workspace);

/// Whether collide() may make the contacts of such a pair without looking for pairs of triangles. Its stats then count
/// none. May throw std::bad_alloc.
bool mayNeedNoTriangles(const Query& query);

/// All contacts of `solid` of a pair -> workspace.contacts that do not contradict each other. Of these as many as the
/// caller wants -> workspace.reduced. False for a jammed pair: see cutContradictions().
bool finishContacts(const Query& query, Workspace& workspace);

/// The same of two meshes. Of a jammed pair of solids the regions that hold it get contacts along one direction, which
/// push it out (jammed_pair.cpp). May throw std::bad_alloc, and throws what middlePhase throws.
void finishPair(const Query& query, Workspace& workspace);

/// limitContacts() for contacts in the callers' numbers of triangles. Ties are broken by the meshes' own.
std::vector<Contact> limitContactsOfCaller(const Query& query, std::span<const Contact> contacts, int count);

/// The last step of a query: the contacts of workspace.reduced name triangles as the caller numbers them.
void numberAsCaller(const Query& query, Workspace& workspace);

}  // namespace otg
