// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/povray_contacts.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

#include "base/vectors.h"
#include "scenes/povray_surface.h"

namespace otg::scenes {
namespace {

// Edges at which faces meet at more than this angle are drawn.
const double kSharpCosine = std::cos(35.0 / 180.0 * 3.14159265358979323846);

std::string text(const Vec3d& v) {
  return fmt::format("<{:.6g},{:.6g},{:.6g}>", v.x, v.y, v.z);
}

std::string matrix(const Transformd& m) {
  const double* r = m.r;
  return fmt::format("matrix <{:.9g},{:.9g},{:.9g}, {:.9g},{:.9g},{:.9g}, {:.9g},{:.9g},{:.9g}, {:.9g},{:.9g},{:.9g}>",
                     r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8], m.t.x, m.t.y, m.t.z);
}

Vec3d corner(const TriMesh& mesh, std::uint32_t v) {
  const Vec3f& p = mesh.vertices()[v];
  return {p.x, p.y, p.z};
}

Vec3d normalOf(const TriMesh& mesh, std::size_t triangle) {
  const Triangle& t = mesh.triangles()[triangle];
  const Vec3d a = corner(mesh, t.v[0]);
  const Vec3d n = otgCross(corner(mesh, t.v[1]) - a, corner(mesh, t.v[2]) - a);
  const double length = norm(n);
  return length > 0 ? n * (1 / length) : Vec3d{0, 0, 0};
}

/// Half-edges whose edges are sharp, one for each edge; none where there are so many that they would hide the rest.
std::vector<std::size_t> sharpEdges(const TriMesh& mesh) {
  constexpr std::size_t kMost = 300;
  std::vector<std::size_t> sharp;
  for (std::size_t half = 0; half < 3 * mesh.triangleCount(); ++half) {
    const std::uint32_t twin = mesh.topology().twin[half];
    if (twin == kNone || twin < half) continue;
    if (otgDot(normalOf(mesh, half / 3), normalOf(mesh, twin / 3)) > kSharpCosine) continue;
    if (sharp.size() == kMost) return {};
    sharp.push_back(half);
  }
  return sharp;
}

void writeSharpEdges(fmt::ostream& out, const PictureBody& body, double radius) {
  const TriMesh& mesh = *body.surface;
  for (const std::size_t half : sharpEdges(mesh)) {
    const Triangle& t = mesh.triangles()[half / 3];
    out.print("  cylinder {{ {}, {}, {:.6g} EdgeLook({}) }}\n",
              text(otgTransform(body.pose, corner(mesh, t.v[half % 3]))),
              text(otgTransform(body.pose, corner(mesh, t.v[(half % 3 + 1) % 3]))), radius, text(body.color));
  }
}

void writeArrow(fmt::ostream& out, const PictureArrow& arrow, double thickness) {
  // The tip keeps its shape; an arrow shorter than its tip is a smaller tip.
  const double tip = std::min(4 * thickness, arrow.length);
  const Vec3d neck = arrow.position + arrow.direction * (arrow.length - tip);
  const Vec3d end = arrow.position + arrow.direction * arrow.length;
  out.print("  sphere {{ {}, {:.6g} ArrowLook({}) }}\n", text(arrow.position), 1.8 * thickness, text(arrow.color));
  if (arrow.length > tip) {
    out.print("  cylinder {{ {}, {}, {:.6g} ArrowLook({}) }}\n", text(arrow.position), text(neck), thickness,
              text(arrow.color));
  }
  if (tip > 0) {
    out.print("  cone {{ {}, {:.6g}, {}, 0 ArrowLook({}) }}\n", text(neck), 2.4 * thickness * tip / (4 * thickness),
              text(end), text(arrow.color));
  }
}

constexpr const char* kLook = R"(
background { rgb 1 }
#macro BodyLook(Color)
  texture {
    pigment { rgb Color transmit 0.72 }
    finish { ambient 0.45 diffuse 0.5 specular 0.15 roughness 0.05 }
  }
  no_shadow
#end
#macro EdgeLook(Color)
  texture { pigment { rgb Color * 0.45 transmit 0.35 } finish { ambient 1 diffuse 0 } }
  no_shadow
#end
#macro ArrowLook(Color)
  texture { pigment { rgb Color } finish { ambient 0.45 diffuse 0.6 specular 0.2 } }
  no_shadow
#end
)";

}  // namespace

void writePovrayContacts(const std::string& path, const ContactPicture& picture) {
  fmt::ostream out = openPovrayFile(path);
  const Vec3d look = unit(picture.look), right = unit(otgCross(look, Vec3d{0, 0, 1})), up = otgCross(right, look);
  const double width = 2 * picture.radius, height = width * ContactPicture::kPanelHeight;
  const auto panels = static_cast<double>(picture.panels.size());
  out.print("#version 3.7;\nglobal_settings {{ assumed_gamma 1 max_trace_level 40 }}\n");
  // Right-handed: the vector to the right is given as it is.
  out.print("camera {{ orthographic location {} direction {} right {} up {} }}\n",
            text(picture.center - look * (4 * picture.radius)), text(look), text(right * (panels * width)),
            text(up * height));
  const auto light = [&](double x, double y, double z, double strength) {
    const Vec3d from = right * x + up * y + look * z;
    out.print("light_source {{ {} rgb {} shadowless parallel point_at {} }}\n",
              text(picture.center + from * (100 * picture.radius)), strength, text(picture.center));
  };
  light(-1, 2, -1.5, 0.9);
  light(2, 0.5, -1, 0.3);
  out.print("{}", kLook);
  std::map<const TriMesh*, std::size_t> surfaces;
  for (const PictureBody& body : picture.bodies) {
    const auto [place, isNew] = surfaces.try_emplace(body.surface.get(), surfaces.size());
    if (isNew) writePovraySurface(out, place->second, *body.surface);
  }
  out.print("#declare Bodies = union {{\n");
  for (const PictureBody& body : picture.bodies) {
    out.print("  object {{ Surface_{} BodyLook({}) {} }}\n", surfaces[body.surface.get()], text(body.color),
              matrix(body.pose));
    writeSharpEdges(out, body, 0.003 * picture.radius);
  }
  out.print("  clipped_by {{ intersection {{");  // to the panel
  for (const auto& [axis, half] : {std::pair(right, 0.49 * width), std::pair(up, 0.5 * height)}) {
    for (const double side : {1.0, -1.0}) {
      const Vec3d n = axis * side;
      out.print(" plane {{ {}, {:.6g} }}", text(n), otgDot(n, picture.center) + half);
    }
  }
  out.print(" }} }}\n}}\n");
  for (std::size_t i = 0; i < picture.panels.size(); ++i) {
    const double shift = (static_cast<double>(i) - 0.5 * (panels - 1)) * width;
    out.print("union {{\n  object {{ Bodies }}\n");
    for (const PictureArrow& arrow : picture.panels[i].arrows) writeArrow(out, arrow, picture.thickness);
    const Vec3d corner = picture.center + right * (-0.94 * picture.radius) + up * (-0.475 * height);
    const double size = 0.13 * picture.radius;
    const Vec3d x = right * size, y = up * size, z = look * size;
    out.print(
        "  text {{ internal 2 \"{}\" 0.01, 0 texture {{ pigment {{ rgb 0 }} finish {{ ambient 1 diffuse 0 }} }}\n",
        picture.panels[i].label);
    // In front of everything.
    out.print("    {} }}\n",
              matrix({{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}, corner - look * (3 * picture.radius)}));
    out.print("  translate {}\n}}\n", text(right * shift));
  }
  out.close();
}

}  // namespace otg::scenes
