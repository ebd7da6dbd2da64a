// SPDX-License-Identifier: BSD-3-Clause
// `otg bench contacts --pictures`: a few overlaps with the truth, our contacts and stock ODE's side by side.
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

using scenes::PictureArrow;

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

void writePicture(const std::string& folder, const truth::ContactFamily& family, const PictureScene& scene) {
  truth::Random random(scene.seed);
  const truth::Placement placement = family.place(random, scene.overlap);
  const truth::VolumeGradient gradient = truth::volumeGradient(family.a->mesh(), family.b->mesh(), placement.bInA);
  const double area = std::sqrt(otgDot(gradient.push, gradient.push));
  // Where there is no formula, the direction in which the overlap shrinks fastest, and its mean thickness there.
  const truth::Separation right =
      placement.truth ? *placement.truth
                      : truth::Separation{otgScale(gradient.push, 1 / area), 2 * gradient.overlap.volume / area};
  const Transformd turn = upright(right.direction);
  const auto share = [](const TriMesh& mesh) { return std::shared_ptr<const TriMesh>(&mesh, [](const TriMesh*) {}); };
  scenes::ContactPicture picture;
  picture.bodies.push_back({share(family.b->mesh()), after(turn, placement.bInA), {0.85, 0.55, 0.15}});
  picture.bodies.push_back({share(family.a->mesh()), turn, {0.20, 0.40, 0.80}});
  picture.center = otgRotate(turn, gradient.overlap.centroid);
  picture.radius = scene.reach * family.size;
  picture.thickness = 0.012 * picture.radius;
  // All arrows in the same measure: the right depth is a third of the panel.
  const double scale = 0.6 * picture.radius / right.depth;
  const auto arrowOf = [&](const truth::PlainContact& c) {
    const double off = truth::angleBetween(c.normal, right.direction);
    return PictureArrow{otgRotate(turn, c.position), otgRotate(turn, c.normal),
                        std::min(scale * c.depth, 1.5 * picture.radius), colorOf(off)};
  };
  picture.panels.push_back({placement.truth ? "truth" : "gradient of the overlap",
                            {arrowOf({gradient.overlap.centroid, right.direction, right.depth})}});
  for (const ContactMethod& method : contactMethods()) {
    const bool stock = method.name.starts_with("ODE dTriMesh");
    if (!stock && method.name != "solid, 64") continue;
    scenes::PicturePanel& panel = picture.panels.emplace_back();
    panel.label = stock ? "ODE dTriMesh" : "solid";
    for (const truth::PlainContact& c : method.contacts(*family.a, *family.b, placement.bInA)) {
      if (c.depth > 0) panel.arrows.push_back(arrowOf(c));
    }
  }
  const std::string path = (std::filesystem::path(folder) / (std::string(scene.file) + ".pov")).string();
  scenes::writePovrayContacts(path, picture);
  progress(fmt::format("{}: width over height {:.4f}", path, picture.aspect()));
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
  }
  // The last one is the mesh of the command line.
  writePicture(folder, families.back(), {"contacts_mesh", 0.3, 7, 2});
}

}  // namespace otg::cli
