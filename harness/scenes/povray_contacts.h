// SPDX-License-Identifier: BSD-3-Clause
// Contacts drawn on the meshes that they are of, as input of the ray tracer POV-Ray.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mesh/tri_mesh.h"

namespace otg::scenes {

/// A mesh, half transparent, its sharp edges drawn.
struct PictureBody {
  std::shared_ptr<const TriMesh> surface;
  Transformd pose{};
  Vec3d color{0.7, 0.7, 0.7};  ///< linear RGB
};

/// A contact: a ball at the position, an arrow from it along the normal.
struct PictureArrow {
  Vec3d position{}, direction{};  ///< direction: unit
  double length = 1;
  Vec3d color{0.7, 0.7, 0.7};
};

struct PicturePanel {
  std::string label;
  std::vector<PictureArrow> arrows;
};

/// Panels side by side, all with the same bodies. z is up in the picture; the view is along `look` (any length, not
/// upright), without perspective.
struct ContactPicture {
  std::vector<PictureBody> bodies;
  std::vector<PicturePanel> panels;
  Vec3d center{};           ///< the middle of each panel
  double radius = 1;        ///< what is drawn lies within it
  double thickness = 0.01;  ///< radius of the arrows' shafts
  Vec3d look{0.3, 1, -0.25};
  /// Width over height of the whole picture; give the renderer the same.
  double aspect() const { return static_cast<double>(panels.size()) / kPanelHeight; }
  static constexpr double kPanelHeight = 1.1;  ///< of a panel, over its width
};

/// One self-contained file. Throws std::runtime_error if it cannot be written.
void writePovrayContacts(const std::string& path, const ContactPicture& picture);

}  // namespace otg::scenes
