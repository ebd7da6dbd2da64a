// SPDX-License-Identifier: BSD-3-Clause
// The reduction step of a query.
#include "collide/reduction.h"

namespace otg {

void reduceContacts(const Query& query, Workspace& workspace) {
  const CollideOptions& options = query.options;
  switch (options.reduction.method) {
    case Reduction::kNone:
      workspace.reduced = limitContacts(workspace.contacts, options.maxContacts);
      return;
    case Reduction::kBinning:
      workspace.reduced =
          limitContacts(reduceByBinning(workspace.contacts, options.reduction.bins), options.maxContacts);
      return;
    case Reduction::kCone:
      workspace.reduced = limitContacts(reduceToCone(workspace.contacts), options.maxContacts);
      return;
  }
}

}  // namespace otg
