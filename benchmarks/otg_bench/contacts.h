// SPDX-License-Identifier: BSD-3-Clause
// What `otg bench contacts` compares: ways to contacts, each run on the same pairs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bvh/collision_mesh.h"
#include "truth/contact_errors.h"
#include "truth/contact_families.h"

namespace otg::cli {

struct ContactMethod {
  std::string name;
  /// Throws std::runtime_error where the library cannot give a result.
  std::function<std::vector<truth::PlainContact>(const CollisionMesh& a, const CollisionMesh& b, const Transformd&)>
      contacts;
};

/// The contact model `solid` with at most so many contacts; 0: all that it has, none left out of any region.
std::vector<truth::PlainContact> solidContactsOf(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA,
                                                 int maxContacts);
/// `solid` with 64 and 8 places, `pairwise` with 64, then stock ODE with 64, FCL and Bullet as far as they are there.
/// An OdeSession must exist while they are used.
std::vector<ContactMethod> contactMethods();

/// Scenes for POV-Ray into `folder`: the truth, our contacts, and stock ODE's where it is there, on overlaps of a few
/// of the families and of the last one.
void writeContactPictures(const std::string& folder, const std::vector<truth::ContactFamily>& families);

}  // namespace otg::cli
