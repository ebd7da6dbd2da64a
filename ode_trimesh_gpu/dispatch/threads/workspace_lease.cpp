// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/threads/workspace_lease.h"

#include <memory>
#include <vector>

#include "base/of_thread.h"

namespace otg {
namespace {

/// The thread's scratch is gone: programs may collide and close the library in the destructors of their own globals.
thread_local bool hasEnded = false;

struct ThreadScratch {
  std::vector<std::unique_ptr<Workspace>> workspaces;
  std::size_t inUse = 0;
  ThreadScratch() = default;
  ~ThreadScratch() { hasEnded = true; }
  ThreadScratch(const ThreadScratch&) = delete;
  ThreadScratch& operator=(const ThreadScratch&) = delete;
};
}  // namespace

WorkspaceLease::WorkspaceLease() {
  if (hasEnded) {
    own_ = std::make_unique<Workspace>();
    workspace_ = own_.get();
    return;
  }
  ThreadScratch& scratch = ofThread<ThreadScratch>();
  if (scratch.inUse == scratch.workspaces.size()) scratch.workspaces.push_back(std::make_unique<Workspace>());
  workspace_ = scratch.workspaces[scratch.inUse++].get();
}

WorkspaceLease::~WorkspaceLease() {
  if (own_ == nullptr) --ofThread<ThreadScratch>().inUse;
}

void freeThreadWorkspaces() noexcept {
  if (hasEnded) return;
  if (ThreadScratch& scratch = ofThread<ThreadScratch>(); scratch.inUse == 0) scratch.workspaces.clear();
}

}  // namespace otg
