// SPDX-License-Identifier: BSD-3-Clause
// What a scene file says (docs/scene_format.md), as plain data. Metres, seconds, kilograms, radians.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "mesh/tri_mesh.h"
#include "scenes/height_grid.h"

namespace otg::scenes {

/// Which of ODE's geoms stands for a body.
enum class Collider { kGpuTriMesh, kOdeTriMesh, kPrimitive };
enum class Stepper { kWorld, kQuick };
enum class SpaceKind { kSimple, kHash, kSap, kQuadTree };
enum class ShapeKind { kMesh, kBox, kSphere, kCylinder, kCapsule, kHeightfield };

/// How far from the origin bodies may be, in metres along each axis. ODE's hash space cuts space into cells of an
/// eighth of a metre or more. It ends the program where their numbers are no 32-bit integers.
inline constexpr double kFarthest = 1e8;

struct BodyDescription {
  std::string name;
  ShapeKind shape = ShapeKind::kMesh;
  Collider collider = Collider::kGpuTriMesh;
  std::shared_ptr<const TriMesh> mesh;        ///< set unless collider is kPrimitive
  std::shared_ptr<const HeightGrid> heights;  ///< of a heightfield, which is static
  /// Box: side lengths. Sphere: radius. Cylinder and capsule (along z): radius, height (without the caps).
  Vec3d size{};
  bool isStatic = false;
  Vec3d position{};                   ///< of the shape's own origin
  double rotation[4] = {1, 0, 0, 0};  ///< quaternion w, x, y, z
  Vec3d linearVelocity{}, angularVelocity{};
  std::optional<double> mass;  ///< else volume x density
  double density = 1000;
  std::optional<double> mu;      ///< else the scene's; a contact takes the smaller of its two
  std::optional<double> bounce;  ///< else the scene's; a contact takes the larger of its two
  std::optional<Vec3d> color;    ///< linear RGB in [0, 1]
};

/// Half-space n . x <= d that fills everything below it.
struct PlaneDescription {
  Vec3d normal{0, 0, 1};
  double offset = 0;
};

struct SceneDescription {
  Vec3d gravity{0, 0, -9.81};
  double dt = 0.005;
  int steps = 400;
  Stepper stepper = Stepper::kQuick;
  int iterations = 20;  ///< of the quick stepper
  double erp = 0.2, cfm = 1e-5;
  double mu = 1;  ///< infinity: no sliding
  double bounce = 0, bounceVelocity = 0.01;
  double surfaceLayer = 0;  ///< depth that contacts are left with
  double maxCorrectingVelocity = std::numeric_limits<double>::infinity();
  double linearDamping = 0, angularDamping = 0;
  int maxContacts = 64;        ///< for each pair of geoms
  int contactsPerRegion = 16;  ///< of gpu_trimesh pairs: at most this many for one connected overlap
  double regionMerge = 0;      ///< of gpu_trimesh pairs: overlaps that come nearer to each other than this are one
  bool history = true;         ///< of gpu_trimesh pairs: whether earlier queries may guide the next one
  SpaceKind space = SpaceKind::kHash;
  std::uint32_t seed = 0;  ///< of ODE's own random numbers (the quick stepper shuffles its rows)
  std::vector<PlaneDescription> planes;
  std::vector<BodyDescription> bodies;
};

/// The scene is wrong; what() names the file, the key and what is wrong.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads a scene file and the meshes that it names (relative to its folder). Throws SceneError or mesh_io::LoadError.
SceneDescription loadScene(const std::string& path);
/// The same from text; `source` starts every message, mesh files are looked for in `folder`.
SceneDescription parseScene(const std::string& text, const std::string& source, const std::string& folder);

}  // namespace otg::scenes
