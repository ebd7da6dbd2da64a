// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/threads/workspace_lease.h"

#include <memory>
#include <vector>

namespace otg {
namespace {

struct ThreadScratch {
  std::vector<std::unique_ptr<Workspace>> workspaces;
  std::size_t inUse = 0;
};
thread_local ThreadScratch scratch;

}  // namespace

WorkspaceLease::WorkspaceLease() {
  if (scratch.inUse == scratch.workspaces.size()) scratch.workspaces.push_back(std::make_unique<Workspace>());
  workspace_ = scratch.workspaces[scratch.inUse++].get();
}

WorkspaceLease::~WorkspaceLease() {
  --scratch.inUse;
}

void freeThreadWorkspaces() noexcept {
  if (scratch.inUse == 0) scratch.workspaces.clear();
}

}  // namespace otg
