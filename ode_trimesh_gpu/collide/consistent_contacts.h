// SPDX-License-Identifier: BSD-3-Clause
// Contacts of a pair that no motion satisfies together.
#pragma once

#include <span>
#include <vector>

#include "collide/query.h"

namespace otg {

/// Whether there is no short motion of the pair, translation and rotation, that takes every contact apart by its depth.
/// So it is where a body is jammed between two walls. Whatever the order of contacts. `size`: the radius of the smaller
/// of the two, which a rotation moves even where all contacts are near its axis.
bool contradict(std::span<const Contact> contacts, double size);

/// Takes their depth from contacts that contradict deeper ones, and leaves out contacts without depth that contradict
/// the rest. So some motion satisfies what is left. An exact solver of contact forces reacts to contradictions with
/// forces of any size. The order of the contacts stays.
void makeConsistent(std::vector<Contact>& contacts, double size);

/// Whether one of the pair's contacts is as deep as entangled pairs are clamped to, or deeper.
bool isDeep(const Query& query, std::span<const Contact> contacts);

/// The same as makeConsistent(). True if the pair is jammed: it was deep, and no contact is as deep any more.
bool cutContradictions(const Query& query, std::vector<Contact>& contacts);

}  // namespace otg
