// SPDX-License-Identifier: BSD-3-Clause
// `otg bench contacts --pictures`: a few overlaps with the truth, our contacts and stock ODE's side by side. One shows
// the contacts before and after reduction.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cli/command.h"
#include "otg_bench/contacts.h"
#include "scenes/povray_contacts.h"
#include "truth/contact_families.h"

namespace otg::cli {
namespace {

struct PictureScene {
  const char* file;
  double overlap;  ///< in the family's size
  std::uint32_t seed;
  double reach;  ///< half the width of a panel, in the family's size
};

/// Rotation that takes a unit vector to +z.
Transformd upright(const Vec3d& n) {
  const Vec3d axis = std::fabs(n.x) < 0.8 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  Vec3d u = otgSub(axis, otgScale(n, otgDot(axis, n)));
  u = otgScale(u, 1 / std::sqrt(otgDot(u, u)));
  const Vec3d v = otgCross(n, u);
  return {{u.x, u.y, u.z, v.x, v.y, v.z, n.x, n.y, n.z}, {0, 0, 0}};
}

Transformd after(const Transformd& turn, const Transformd& pose) {
  Transformd out{};
  for (int k = 0; k < 3; ++k) {
    const Vec3d column = otgRotate(turn, Vec3d{pose.r[k], pose.r[3 + k], pose.r[6 + k]});
    out.r[k] = column.x;
    out.r[3 + k] = column.y;
    out.r[6 + k] = column.z;
  }
  out.t = otgTransform(turn, pose.t);
  return out;
}

/// Green for the right direction, red from 20 degrees off.
Vec3d colorOf(double degrees) {
  const double x = std::clamp(degrees / 20, 0.0, 1.0);
  return x < 0.5 ? Vec3d{0.05 + 1.6 * x, 0.55, 0.05} : Vec3d{0.85, 0.55 * 2 * (1 - x), 0.03};
}

/// A picture of one placement of two bodies. Panels are still to be added.
class PlacedPicture {
 public:
  PlacedPicture(const truth::ContactFamily& family, const PictureScene& scene) : family_(family), file_(scene.file) {
    truth::Random random(scene.seed);
    placement_ = family.place(random, scene.overlap);
    gradient_ = truth::volumeGradient(family.a->mesh(), family.b->mesh(), placement_.bInA);
    const double area = std::sqrt(otgDot(gradient_.push, gradient_.push));
    // Where there is no formula, the direction in which the overlap shrinks fastest, and its mean thickness there.
    right_ = placement_.truth
                 ? *placement_.truth
                 : truth::Separation{otgScale(gradient_.push, 1 / area), 2 * gradient_.overlap.volume / area};
    turn_ = upright(right_.direction);
    const auto share = [](const TriMesh& mesh) { return std::shared_ptr<const TriMesh>(&mesh, [](const TriMesh*) {}); };
    picture_.bodies.push_back({share(family.b->mesh()), after(turn_, placement_.bInA), {0.85, 0.55, 0.15}});
    picture_.bodies.push_back({share(family.a->mesh()), turn_, {0.20, 0.40, 0.80}});
    picture_.center = otgRotate(turn_, gradient_.overlap.centroid);
    picture_.radius = scene.reach * family.size;
    picture_.thickness = 0.012 * picture_.radius;
  }

  void addTruth() {
    addPanel(placement_.truth ? "truth" : "gradient of the overlap",
             {{gradient_.overlap.centroid, right_.direction, right_.depth}});
  }
  /// All arrows in the same measure: the right depth is a third of the panel.
  void addPanel(const std::string& label, const std::vector<truth::PlainContact>& contacts) {
    scenes::PicturePanel& panel = picture_.panels.emplace_back();
    panel.label = label;
    for (const truth::PlainContact& c : contacts) {
      if (!(c.depth > 0)) continue;
      const double length = std::min(0.6 * picture_.radius * c.depth / right_.depth, 1.5 * picture_.radius);
      panel.arrows.push_back({otgRotate(turn_, c.position), otgRotate(turn_, c.normal), length,
                              colorOf(truth::angleBetween(c.normal, right_.direction))});
    }
  }
  void thinArrows() { picture_.thickness /= 2; }
  const truth::ContactFamily& family() const { return family_; }
  const Transformd& bInA() const { return placement_.bInA; }

  void write(const std::string& folder) const {
    const std::string path = (std::filesystem::path(folder) / (file_ + ".pov")).string();
    scenes::writePovrayContacts(path, picture_);
    progress(fmt::format("{}: width over height {:.4f}", path, picture_.aspect()));
  }

 private:
  const truth::ContactFamily& family_;
  std::string file_;
  truth::Placement placement_;
  truth::VolumeGradient gradient_;
  truth::Separation right_;
  Transformd turn_{};
  scenes::ContactPicture picture_;
};

void writePicture(const std::string& folder, const truth::ContactFamily& family, const PictureScene& scene) {
  PlacedPicture picture(family, scene);
  picture.addTruth();
  for (const ContactMethod& method : contactMethods()) {
    const bool stock = method.name.starts_with("ODE dTriMesh");
    if (!stock && method.name != "solid, 64") continue;
    picture.addPanel(stock ? "ODE dTriMesh" : "solid", method.contacts(*family.a, *family.b, picture.bInA()));
  }
  picture.write(folder);
}

/// All contacts of `solid`, those that its reduction leaves of each region, and those that a limit of 4 leaves.
void writeReduction(const std::string& folder, const truth::ContactFamily& family, const PictureScene& scene) {
  PlacedPicture picture(family, scene);
  picture.thinArrows();
  for (const int most : {0, 65535, 4}) {
    const std::vector<truth::PlainContact> contacts = solidContactsOf(*family.a, *family.b, picture.bInA(), most);
    const char* what = most == 0 ? "before reduction" : most == 4 ? "with a limit" : "after reduction";
    picture.addPanel(fmt::format("{}: {}", what, contacts.size()), contacts);
  }
  picture.write(folder);
}

}  // namespace

void writeContactPictures(const std::string& folder, const std::vector<truth::ContactFamily>& families) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder + ": cannot be made: " + error.message());
  constexpr std::pair<const char*, PictureScene> kScenes[] = {
      {"spheres", {"contacts_spheres", 0.3, 3, 1.2}},   {"boxes_face_turned", {"contacts_boxes", 0.1, 5, 3.2}},
      {"ball_box", {"contacts_ball_box", 0.2, 4, 1.6}}, {"cylinder_on_box", {"contacts_cylinder_on_box", 0.1, 2, 3.0}},
      {"tori_stacked", {"contacts_tori", 0.3, 2, 5}},
  };
  for (const truth::ContactFamily& family : families) {
    for (const auto& [name, scene] : kScenes) {
      if (family.name == name) writePicture(folder, family, scene);
    }
    if (family.name == "tori_stacked") writeReduction(folder, family, {"contacts_reduction", 0.3, 2, 5});
  }
  // The last one is the mesh of the command line.
  writePicture(folder, families.back(), {"contacts_mesh", 0.3, 7, 2});
}

}  // namespace otg::cli
