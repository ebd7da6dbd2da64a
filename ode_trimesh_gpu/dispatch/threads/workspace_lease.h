// SPDX-License-Identifier: BSD-3-Clause
// Workspaces that a thread keeps between collisions.
#pragma once

#include <memory>

#include "collide/query.h"

namespace otg {

/// A workspace of the calling thread for as long as this lives. Several at once where a collision runs inside another
/// one of the same thread. The constructor may throw std::bad_alloc.
class WorkspaceLease {
 public:
  WorkspaceLease();
  ~WorkspaceLease();
  WorkspaceLease(const WorkspaceLease&) = delete;
  WorkspaceLease& operator=(const WorkspaceLease&) = delete;
  Workspace& operator*() const { return *workspace_; }

 private:
  Workspace* workspace_;
  std::unique_ptr<Workspace> own_;  ///< at the end of the thread, when it keeps none any more
};

/// Frees what the calling thread keeps, unless it is in use.
void freeThreadWorkspaces() noexcept;

}  // namespace otg
