// SPDX-License-Identifier: BSD-3-Clause
// The scene format: JSON text to SceneDescription. docs/scene_format.md is its manual.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "base/vectors.h"
#include "mesh_io/mesh_file.h"
#include "scenes/generated_meshes.h"
#include "scenes/height_grid_file.h"
#include "scenes/heightfield_geom.h"
#include "scenes/json_reader.h"

namespace otg::scenes {
namespace {

using nlohmann::json;
/// What bodies refer to by name.
struct NamedShapes {
  std::map<std::string, std::shared_ptr<const TriMesh>> meshes;
  std::map<std::string, std::shared_ptr<const HeightGrid>> heightfields;
};

constexpr double kLargest = 1e9;  // metres; beyond it single precision has no use for a mesh
constexpr double kFastest = 1e9;  // metres or radians a second, and of gravity a second more
constexpr double kSmallest = 1e-9;
constexpr int kMostSegments = 4096;
constexpr double kMostTriangles = 5e6;  // of one generated mesh; a slip of the pen must not eat the memory

MeshArrays generate(ObjectReader& reader) {
  const auto length = [&](const char* key) { return reader.requiredNumber(key, kSmallest, kLargest); };
  const auto count = [&](const char* key, int fallback) { return reader.integer(key, fallback, 1, kMostSegments); };
  const auto segments = [&](const char* key, int fallback) { return reader.integer(key, fallback, 3, kMostSegments); };
  const auto size = [&](const char* key) {
    const Vec3d v = reader.vector(key, {0, 0, 0});
    if (!(v.x > 0 && v.y > 0 && v.z > 0)) reader.fail(key, "must be three lengths above 0");
    return v;
  };
  const auto limit = [&](const char* key, double triangles) {
    if (triangles > kMostTriangles) reader.fail(key, "the mesh would have more than 5 million triangles");
  };
  const std::string kind = reader.text("generate", "");
  if (kind == "box") return makeBox(size("size"), reader.integer("divisions", 1, 1, 512));
  if (kind == "sphere") return makeSphere(length("radius"), reader.integer("level", 3, 0, 8));
  if (kind == "torus") {
    const int major = segments("major_segments", 48), minor = segments("minor_segments", 24);
    limit("major_segments", 2.0 * major * minor);
    return makeTorus(length("major_radius"), length("minor_radius"), major, minor);
  }
  if (kind == "cylinder") {
    const int around = segments("segments", 32), stacks = count("stacks", 1);
    limit("segments", 2.0 * around * (stacks + 1));
    return makeCylinder(length("radius"), length("height"), around, stacks);
  }
  if (kind == "bowl") {
    const int around = segments("segments", 48), rings = count("rings", 12);
    limit("segments", 4.0 * around * (rings + 1));
    return makeBowl(length("radius"), length("thickness"), around, rings);
  }
  if (kind == "gear") {
    return makeGear(segments("teeth", 16), length("pitch_radius"), length("tooth_depth"), length("width"),
                    reader.number("bore_radius", 0, 0, kLargest));
  }
  if (kind == "lump") {
    return makeLump(length("radius"), reader.integer("level", 4, 0, 8), reader.number("amplitude", 0.3, 0, 0.9),
                    static_cast<std::uint32_t>(reader.integer("seed", 1, 0, 1 << 30)));
  }
  if (kind == "ground") {
    // Hills: product of cosines, so that the ground is smooth and its middle is a top.
    const double extent = length("size"), thickness = length("thickness");
    const int divisions = reader.integer("divisions", 32, 1, 1024);
    const double height = reader.number("hill_height", 0, -kLargest, kLargest);
    const double wave = reader.number("hill_length", extent, kSmallest, kLargest);
    if (height == 0) return makeGround(extent, thickness, divisions);
    return makeGround(extent, thickness, divisions, [=](double x, double y) {
      const double k = 2 * 3.14159265358979323846 / wave;
      return height * std::cos(k * x) * std::cos(k * y);
    });
  }
  if (kind == "block_with_hole") return makeBlockWithHole(size("size"), length("hole"));
  if (kind == "bolt" || kind == "nut") {
    const double pitch = length("pitch"), extent = length("length");
    const int around = segments("segments", 48);
    limit("pitch", 8.0 * around * (extent / pitch + 2));
    if (kind == "bolt") return makeBolt(length("radius"), pitch, extent, around);
    return makeNut(length("radius"), pitch, extent, length("clearance"), around);
  }
  reader.fail("generate", "'" + kind +
                              "' is none of: box, sphere, torus, cylinder, bowl, gear, lump, ground, block_with_hole, "
                              "bolt, nut");
}

/// Uniformly scaled copy, for a mesh that comes in millimetres, say.
void scale(std::vector<Vec3d>& vertices, double factor) {
  for (Vec3d& v : vertices) v = v * factor;
}

std::shared_ptr<const TriMesh> readMesh(const json& value, const std::string& where, const std::string& folder) {
  ObjectReader reader(value, where);
  if (reader.has("generate") == reader.has("file")) {
    throw SceneError(where + ": needs either the key 'file' or the key 'generate'");
  }
  const double factor = reader.number("scale", 1, kSmallest, kLargest);
  mesh_io::MeshFile arrays;
  RepairOptions repair;
  if (reader.has("generate")) {
    const MeshArrays generated = generate(reader);
    for (const Vec3f& v : generated.vertices) arrays.vertices.push_back({v.x, v.y, v.z});
    arrays.triangles = generated.triangles;
  } else {
    if (reader.boolean("repair", false)) repair = RepairOptions::all();
    arrays = mesh_io::loadMeshFile((std::filesystem::path(folder) / reader.text("file", "")).string());
  }
  if (factor != 1) scale(arrays.vertices, factor);
  // The centred frame of a scanned mesh is seldom its origin; poses are easier to write for a centred one.
  const bool center = reader.boolean("center", false);
  reader.finish();
  MeshResult result = buildTriMesh(arrays.input(), repair);
  if (result.mesh && center && result.mesh->triangleCount() > 0) {
    const Vec3f c = result.mesh->center();
    for (Vec3d& v : arrays.vertices) v = v - Vec3d{c.x, c.y, c.z};
    result = buildTriMesh(arrays.input(), repair);
  }
  if (!result.mesh) throw SceneError(where + ": the mesh is refused: " + result.report.error);
  if (reader.has("generate") && result.mesh->meshClass() != MeshClass::kSolid) {
    throw SceneError(where + ": these proportions make no solid");
  }
  if (result.mesh->triangleCount() == 0) throw SceneError(where + ": the mesh has no triangles");
  return result.mesh;
}

/// An object of named things, each read by `read(value, where)`.
template <class Read>
auto readTable(ObjectReader& reader, const char* key, const std::string& source, const Read& read) {
  std::map<std::string, decltype(read(json(), source))> table;
  const json* const value = reader.member(key);
  if (value == nullptr) return table;
  if (!value->is_object()) reader.fail(key, "must be an object whose members have names");
  for (const auto& entry : value->items()) {
    table[entry.key()] = read(entry.value(), source + ": " + key + "." + entry.key());
  }
  return table;
}

/// The one that the body names.
template <class Table>
auto named(ObjectReader& reader, const char* key, const Table& table) {
  const std::string name = reader.text(key, "");
  const auto found = table.find(name);
  if (found == table.end()) reader.fail(key, std::string("there is no ") + key + " named '" + name + "'");
  return found->second;
}

void readShape(ObjectReader& reader, const NamedShapes& shapesByName, BodyDescription& body) {
  int shapes = 0;
  for (const char* key : {"mesh", "heightfield", "box", "sphere", "cylinder", "capsule"})
    shapes += reader.has(key) ? 1 : 0;
  if (shapes != 1) {
    throw SceneError(reader.where() +
                     ": needs exactly one of the keys mesh, heightfield, box, sphere, cylinder, capsule");
  }
  const auto checkLengths = [&](const char* key, std::initializer_list<double> lengths) {
    for (const double x : lengths) {
      if (!(x >= kSmallest && x <= kLargest)) reader.fail(key, "lengths must be above 0");
    }
  };
  if (reader.has("mesh")) {
    body.shape = ShapeKind::kMesh;
    body.mesh = named(reader, "mesh", shapesByName.meshes);
  } else if (reader.has("heightfield")) {
    body.shape = ShapeKind::kHeightfield;
    body.heights = named(reader, "heightfield", shapesByName.heightfields);
  } else if (reader.has("box")) {
    body.shape = ShapeKind::kBox;
    body.size = reader.vector("box", {});
    checkLengths("box", {body.size.x, body.size.y, body.size.z});
  } else if (reader.has("sphere")) {
    body.shape = ShapeKind::kSphere;
    body.size.x = reader.requiredNumber("sphere", kSmallest, kLargest);
  } else {
    const char* key = reader.has("cylinder") ? "cylinder" : "capsule";
    body.shape = reader.has("cylinder") ? ShapeKind::kCylinder : ShapeKind::kCapsule;
    const std::vector<double> values = *reader.numbers(key, 2);
    checkLengths(key, {values[0], values[1]});
    body.size = {values[0], values[1], 0};
  }
  const Collider fallback = body.shape == ShapeKind::kMesh ? Collider::kGpuTriMesh : Collider::kPrimitive;
  body.collider = reader.choice<Collider>("collider", fallback,
                                          {{"gpu_trimesh", Collider::kGpuTriMesh},
                                           {"ode_trimesh", Collider::kOdeTriMesh},
                                           {"primitive", Collider::kPrimitive}});
  if (body.shape == ShapeKind::kMesh && body.collider == Collider::kPrimitive) {
    reader.fail("collider", "a mesh cannot be a primitive");
  }
  if (body.shape != ShapeKind::kMesh && body.collider != Collider::kPrimitive) {
    if (body.shape == ShapeKind::kBox) {
      body.mesh = build(makeBox(body.size, reader.integer("divisions", 1, 1, 512)));
    } else if (body.shape == ShapeKind::kHeightfield) {
      if (body.heights->wraps) reader.fail("collider", "a field that wraps has no end, and a mesh has one");
      body.mesh = build(sheetOf(*body.heights));
    } else if (body.shape == ShapeKind::kSphere) {
      body.mesh = build(makeSphere(body.size.x, reader.integer("level", 3, 0, 8)));
    } else if (body.shape == ShapeKind::kCylinder) {
      body.mesh = build(makeCylinder(body.size.x, body.size.y, reader.integer("segments", 32, 3, kMostSegments)));
    } else {
      reader.fail("collider", "a capsule can only be a primitive");
    }
  }
}

BodyDescription readBody(const json& value, const std::string& where, const NamedShapes& shapes) {
  ObjectReader reader(value, where);
  BodyDescription body;
  body.name = reader.text("name", "");
  if (body.name.empty()) reader.fail("name", "is missing or empty");
  readShape(reader, shapes, body);
  body.isStatic = reader.boolean("static", false);
  if (body.heights && !body.isStatic) reader.fail("static", "a heightfield must be static");
  body.position = reader.vector("position", {0, 0, 0}, kFarthest);
  if (const auto q = reader.numbers("rotation", 4)) {
    const double length = std::sqrt((*q)[0] * (*q)[0] + (*q)[1] * (*q)[1] + (*q)[2] * (*q)[2] + (*q)[3] * (*q)[3]);
    if (!(std::fabs(length - 1) <= 1e-3)) reader.fail("rotation", "must be a unit quaternion w, x, y, z");
    for (std::size_t i = 0; i < 4; ++i) body.rotation[i] = (*q)[i] / length;
  }
  if (body.heights && body.collider == Collider::kPrimitive && !isOfRightAngles(body.rotation)) {
    reader.fail("rotation", "a heightfield can be turned by right angles only");
  }
  body.linearVelocity = reader.vector("linear_velocity", {0, 0, 0}, kFastest);
  body.angularVelocity = reader.vector("angular_velocity", {0, 0, 0}, kFastest);
  body.mass = reader.optionalNumber("mass", 1e-12, 1e12);
  if (body.mass && reader.has("density")) reader.fail("density", "give either a mass or a density");
  body.density = reader.number("density", 1000, 1e-9, 1e9);
  if (reader.has("mu")) body.mu = reader.numberOrInfinity("mu", 0, 0);
  body.bounce = reader.optionalNumber("bounce", 0, 1);
  if (reader.has("color")) {
    body.color = reader.vector("color", {});
    for (const double x : {body.color->x, body.color->y, body.color->z}) {
      if (!(x >= 0 && x <= 1)) reader.fail("color", "must be three numbers from 0 to 1");
    }
  }
  reader.finish();
  if (body.isStatic) {
    for (const char* key : {"linear_velocity", "angular_velocity", "mass"}) {
      if (reader.has(key)) reader.fail(key, "a static body has none");
    }
  }
  return body;
}

PlaneDescription readPlane(const json& value, const std::string& where) {
  ObjectReader reader(value, where);
  PlaneDescription plane;
  plane.normal = reader.vector("normal", plane.normal);
  const double length = std::sqrt(otgDot(plane.normal, plane.normal));
  if (!(length > 1e-9)) reader.fail("normal", "must not be zero");
  plane.normal = plane.normal * (1 / length);
  plane.offset = reader.number("offset", 0, -kLargest, kLargest);
  reader.finish();
  return plane;
}

}  // namespace

SceneDescription parseScene(const std::string& text, const std::string& source, const std::string& folder) {
  json document;
  try {
    document = json::parse(text, nullptr, true, true);
  } catch (const json::exception& error) {  // parse_error, or out_of_range for a number that no double is
    throw SceneError(source + ": not valid JSON: " + error.what());
  }
  SceneDescription scene;
  ObjectReader reader(document, source);
  scene.gravity = reader.vector("gravity", scene.gravity, kFastest);
  scene.dt = reader.number("dt", scene.dt, 1e-9, 10);
  scene.steps = reader.integer("steps", scene.steps, 0, 100000000);
  scene.stepper =
      reader.choice<Stepper>("stepper", scene.stepper, {{"world", Stepper::kWorld}, {"quick", Stepper::kQuick}});
  scene.iterations = reader.integer("iterations", scene.iterations, 1, 100000);
  scene.erp = reader.number("erp", scene.erp, 0, 1);
  scene.cfm = reader.number("cfm", scene.cfm, 0, 1e12);
  scene.mu = reader.numberOrInfinity("mu", scene.mu, 0);
  scene.bounce = reader.number("bounce", scene.bounce, 0, 1);
  scene.bounceVelocity = reader.number("bounce_velocity", scene.bounceVelocity, 0, 1e12);
  scene.surfaceLayer = reader.number("surface_layer", scene.surfaceLayer, 0, kLargest);
  scene.maxCorrectingVelocity = reader.numberOrInfinity("max_correcting_velocity", scene.maxCorrectingVelocity, 0);
  scene.linearDamping = reader.number("linear_damping", scene.linearDamping, 0, 1);
  scene.angularDamping = reader.number("angular_damping", scene.angularDamping, 0, 1);
  scene.maxContacts = reader.integer("max_contacts", scene.maxContacts, 1, 65535);
  scene.contactsPerRegion = reader.integer("contacts_per_region", scene.contactsPerRegion, 1, 64);
  scene.regionMerge = reader.number("region_merge", scene.regionMerge, 0, kLargest);
  scene.history = reader.boolean("history", scene.history);
  scene.space = reader.choice<SpaceKind>("space", scene.space,
                                         {{"simple", SpaceKind::kSimple},
                                          {"hash", SpaceKind::kHash},
                                          {"sap", SpaceKind::kSap},
                                          {"quadtree", SpaceKind::kQuadTree}});
  scene.seed = static_cast<std::uint32_t>(reader.integer("seed", 0, 0, 1 << 30));
  if (const json* planes = reader.member("planes")) {
    if (!planes->is_array()) reader.fail("planes", "must be an array");
    for (std::size_t i = 0; i < planes->size(); ++i) {
      scene.planes.push_back(readPlane((*planes)[i], source + ": planes[" + std::to_string(i) + "]"));
    }
  }
  NamedShapes shapes;
  shapes.meshes = readTable(reader, "meshes", source, [&folder](const json& value, const std::string& where) {
    return readMesh(value, where, folder);
  });
  shapes.heightfields = readTable(reader, "heightfields", source, &readHeightGrid);
  const json* bodies = reader.member("bodies");
  if (bodies == nullptr || !bodies->is_array()) reader.fail("bodies", "is missing or not an array");
  for (std::size_t i = 0; i < bodies->size(); ++i) {
    scene.bodies.push_back(readBody((*bodies)[i], source + ": bodies[" + std::to_string(i) + "]", shapes));
    for (std::size_t k = 0; k < i; ++k) {
      if (scene.bodies[k].name == scene.bodies[i].name) {
        throw SceneError(source + ": two bodies are named '" + scene.bodies[i].name + "'");
      }
    }
  }
  reader.finish();
  return scene;
}

SceneDescription loadScene(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw SceneError(path + ": is a folder");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw SceneError(path + ": the scene file cannot be opened");
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  return parseScene(text, path, std::filesystem::path(path).parent_path().string());
}

}  // namespace otg::scenes
