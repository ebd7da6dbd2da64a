// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/surface_contacts.h"

#include <chrono>

#include "collide/pair_history.h"
#include "collide/rotation_tolerance.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "primitives/face_contacts.h"
#include "primitives/near_surface.h"
#include "primitives/smooth_contacts.h"

namespace otg {

bool collideSurface(const Query& query, const ConvexShape& shape, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  const TriMesh& mesh = query.a->mesh();
  if (shape.kind == ConvexShape::Kind::kCapsule || query.options.contacts != ContactModel::kSolid ||
      !query.options.solid.convexPath || query.a->convex() != nullptr || (!isSolid(mesh) && !isSheet(mesh))) {
    return false;
  }
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  requireRigid(query.bInA);
  const SolidHistory::State before = stateBefore(query);
  if (before.side < 0 || before.escapeLeft > 0 || !isUnburdened(query)) return false;
  workspace.clear();
  NearSurface near(query, shape);
  if (!near.collect()) return false;
  if (!addFaceContacts(near, workspace) && (haveParts(query) || !addSmoothContacts(near, workspace))) return false;
  rememberPlain(query, true, {0, 0, 0});
  workspace.stats.contactsBeforeReduction = workspace.contacts.size();
  finishContacts(query, workspace);
  if (query.options.timings) {
    workspace.stats.contactsMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
  return true;
}

}  // namespace otg
