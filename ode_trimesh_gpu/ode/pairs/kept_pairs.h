// SPDX-License-Identifier: BSD-3-Clause
// The contacts of pairs of meshes that stay where they are.
#pragma once

#include "ode/pairs/kept_contacts.h"
#include "ode/pairs/pair_query.h"
#include "ode/pairs/pair_task.h"

namespace otg {

/// Of the pairs in which the geom is the younger one, by the serial number of the older one; in the caller's numbers.
class KeptPairs final : public KeptContacts<PairQuery> {};

/// The contacts of a task that has its history, if they were kept: for as many as it requests, and before
/// keepOwnContacts(). May throw std::bad_alloc.
bool findKept(const PairTask& task, std::vector<Contact>& contacts, PairCounts& counts);
/// At the end of the same query, with the stamps of what was remembered before it and is now. Contacts are kept where
/// the geoms remember pairs, and the CPU has computed them; not where a device is to. Two convex bodies keep their
/// direction, and take little else.
void foundKept(const PairTask& task, std::uint64_t before, std::uint64_t stamp);
void noteComputed(const PairTask& task, std::uint64_t stamp, std::span<const Contact> contacts,
                  const PairCounts& counts);

}  // namespace otg
