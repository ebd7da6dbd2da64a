// SPDX-License-Identifier: BSD-3-Clause
// From which side the visitor has come to the ground: what the pair remembers.
#pragma once

#include <vector>

#include "collide/shell/ground_surface.h"
#include "collide/shell/shell_roles.h"
#include "collide/solid_options.h"

namespace otg {

/// What a query has to look for.
enum class ShellState {
  kApart,    ///< nothing touches
  kMeeting,  ///< triangles intersect
  kThrough   ///< none do, but the visitor is behind the ground: all of it may be
};

/// Decides on the sides of the ground before contacts are made, and on what is remembered afterwards.
class ShellApproach {
 public:
  ShellApproach(const Query& query, const ShellRoles& roles, const SolidHistory::State& before, GroundSides& sides,
                std::vector<double>& crossings);

  /// `meets`: triangles intersect. Sets the sides.
  ShellState decide(bool meets);
  /// After contacts were made, with the sum of their directions (the ground's frame): what is remembered.
  void finish(ShellState state, bool hasContacts, const Vec3d& sum, SolidHistory::State& after);

  const GroundSurface& surface() const { return surface_; }

 private:
  /// A vertex of the visitor, and how it lies.
  struct Sample {
    Vec3d point{};
    GroundDepth depth;
    bool isFound = false;
  };
  template <class Visit>
  void forSamples(std::size_t most, const Visit& visit) const;
  Sample sampleNear() const;
  Sample sampleFar() const;
  ShellState besideSolid(bool meets);
  ShellState besideSheet(bool meets);
  ShellState besideShell(bool meets);
  int sideOfMeeting() const;
  int sideOfApart(const Sample& sample) const;
  bool isPartlyInFront() const;
  int sideOfBehind() const;
  void carryFront();
  Vec3d frontOfMeeting() const;
  Vec3d frontOfApart(const Sample& sample) const;
  bool crosses(const Vec3d& from, const Vec3d& to) const;

  const Query& query_;
  const ShellRoles& roles_;
  const SolidHistory::State& before_;
  GroundSides& sides_;
  std::vector<double>& crossings_;
  GroundSurface surface_;
  Vec3d velocity_;  ///< of the visitor beside the ground
  int side_ = 0;
  Vec3d front_{};
};

/// Of a pair without contacts of a solid and a larger sheet: -1 if the solid is behind the sheet, where contacts of
/// solids would draw it through; 1 if it has come there through the front, and is to be drawn back; else 0. Of other
/// pairs what was there before.
int sideBehind(const Query& query, const SolidHistory::State& before);

}  // namespace otg
