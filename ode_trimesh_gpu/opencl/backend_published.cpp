// SPDX-License-Identifier: BSD-3-Clause
// The one place in which the library reaches the published design: made here at its first use.
#include "opencl/backend.h"
#include "opencl/backend_state.h"
#include "opencl/published/published_design.h"

namespace otg::opencl {

PublishedDesign& Backend::published() {
  BackendState& state = *state_;
  const std::lock_guard lock(state.publishedMutex);
  if (!state.published) {
    state.published = std::make_shared<PublishedDesign>(state.context, state.meshes, state.tuning,
                                                        PublishedDesign::Counters{state.queries, state.onHost});
  }
  return *state.published;
}

bool Backend::collideByLevels(const Query& query, Workspace& workspace) {
  return published().collideByLevels(query, workspace);
}

bool Backend::findPairsByLevels(const Query& query, Workspace& workspace) {
  return published().findPairsByLevels(query, workspace);
}

bool Backend::findCandidates(const Query& query, Workspace& workspace) {
  return published().findCandidates(query, workspace);
}

bool Backend::findCandidatesByLevels(const Query& query, Workspace& workspace) {
  return published().findCandidatesByLevels(query, workspace);
}

bool Backend::collideCandidates(const Query& query, Workspace& workspace) {
  return published().collideCandidates(query, workspace);
}

bool Backend::decideCandidates(const Query& query, Workspace& workspace) {
  return published().decideCandidates(query, workspace);
}

void Backend::addPublishedCounts(BackendCounts& counts) const {
  const std::lock_guard lock(state_->publishedMutex);
  if (!state_->published) return;
  counts.repeats += state_->published->repeats();
  const MeshStore::Counts meshes = state_->published->meshCounts();
  counts.meshUploads += meshes.uploads;
  counts.meshUpdates += meshes.updates;
  counts.meshBytesSent += meshes.bytesUploaded;
  counts.meshEvictions += meshes.evictions;
  counts.meshBytes += meshes.bytesUsed;
}

}  // namespace otg::opencl
