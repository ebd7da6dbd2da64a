// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/povray_scene.h"

#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>

#include "base/vectors.h"
#include "scenes/povray_surface.h"

namespace otg::scenes {
namespace {

template <class T>
const T& at(const std::vector<T>& poses, std::size_t frame) {
  return poses[std::min(frame, poses.size() - 1)];
}

/// Columns of the rotation matrix and the position, as POV-Ray's `matrix` takes them.
std::string matrix(const std::array<double, 4>& q, const Vec3d& p) {
  const auto [w, x, y, z] = q;
  return fmt::format("matrix <{:.9g},{:.9g},{:.9g}, {:.9g},{:.9g},{:.9g}, {:.9g},{:.9g},{:.9g}, {:.9g},{:.9g},{:.9g}>",
                     1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),  //
                     2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),  //
                     2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), p.x, p.y, p.z);
}

}  // namespace

std::vector<std::string> writePovrayFrames(const std::string& folder, const Recording& recording,
                                           const std::vector<std::size_t>& frames) {
  const std::vector<AnimatedBody>& bodies = recording.bodies;
  const std::filesystem::path root(folder);
  std::error_code error;
  std::filesystem::create_directories(root, error);
  if (error) throw std::runtime_error(folder + ": cannot be made: " + error.message());

  std::map<const TriMesh*, std::size_t> surfaces;
  fmt::ostream meshes = openPovrayFile(root / "meshes.inc");
  for (const AnimatedBody& body : bodies) {
    const auto [place, isNew] = surfaces.try_emplace(body.surface.get(), surfaces.size());
    if (isNew) writePovraySurface(meshes, place->second, *body.surface);
  }
  meshes.close();

  const Stage stage = findStage(bodies);
  const double usual = usualDepth(recording);
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::filesystem::path path = root / fmt::format("frame_{:03}.pov", i);
    fmt::ostream out = openPovrayFile(path);
    out.print("#version 3.7;\n#declare FrameTime = {:.9g};\n", recording.times[frames[i]]);
    out.print("#declare StageCenter = <{:.9g},{:.9g},{:.9g}>;\n#declare StageRadius = {:.9g};\n", stage.center.x,
              stage.center.y, stage.center.z, stage.radius);
    out.print("#include \"look.inc\"\n#include \"meshes.inc\"\n");
    for (const AnimatedBody& body : bodies) {
      out.print("object {{ Surface_{} {}(<{:.4g},{:.4g},{:.4g}>) {} }}\n", surfaces[body.surface.get()],
                body.positions.size() < 2 ? "StillBody" : "MovingBody", body.color.x, body.color.y, body.color.z,
                matrix(at(body.rotations, frames[i]), at(body.positions, frames[i])));
    }
    out.print("#ifdef (ShowContacts)\n");
    for (const ContactArrow& arrow : recording.contacts[frames[i]]) {
      const Vec3d &p = arrow.position, &d = arrow.direction, &color = kDepthColors[depthColor(arrow.depth, usual)];
      out.print("ContactArrow(<{:.9g},{:.9g},{:.9g}>, <{:.6g},{:.6g},{:.6g}>, <{:.4g},{:.4g},{:.4g}>)\n", p.x, p.y, p.z,
                d.x, d.y, d.z, color.x, color.y, color.z);
    }
    out.print("#end\n");
    out.close();
    paths.push_back(path.string());
  }
  return paths;
}

}  // namespace otg::scenes
