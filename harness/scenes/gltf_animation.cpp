// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/gltf_animation.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <stdexcept>

#include "base/vectors.h"
#include "scenes/shaded_surface.h"

namespace otg::scenes {
namespace {

/// Appends arrays to the one buffer of the file and describes them.
class Writer {
 public:
  Writer() { model_.buffers.resize(1); }
  tinygltf::Model& model() { return model_; }

  int addFloats(const std::vector<float>& values, int type, int components, int target, bool bounds) {
    const int accessor = add(values.data(), values.size() * sizeof(float), values.size() / std::size_t(components),
                             TINYGLTF_COMPONENT_TYPE_FLOAT, type, target);
    if (bounds) {
      std::vector<double> lo(std::size_t(components), 1e300), hi(std::size_t(components), -1e300);
      for (std::size_t i = 0; i < values.size(); ++i) {
        double &a = lo[i % std::size_t(components)], &b = hi[i % std::size_t(components)];
        a = std::min(a, double(values[i]));
        b = std::max(b, double(values[i]));
      }
      model_.accessors.back().minValues = lo;
      model_.accessors.back().maxValues = hi;
    }
    return accessor;
  }

  int addIndices(const std::vector<std::uint32_t>& values) {
    return add(values.data(), values.size() * sizeof(std::uint32_t), values.size(),
               TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  }

 private:
  int add(const void* bytes, std::size_t size, std::size_t count, int componentType, int type, int target) {
    auto& data = model_.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = size;
    view.target = target;
    data.resize(data.size() + size);
    if (size > 0) std::memcpy(data.data() + view.byteOffset, bytes, size);
    model_.bufferViews.push_back(view);
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model_.bufferViews.size()) - 1;
    accessor.componentType = componentType;
    accessor.type = type;
    accessor.count = count;
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  tinygltf::Model model_;
};

int addMaterial(tinygltf::Model& model, const Vec3d& color) {
  tinygltf::Material material;
  material.pbrMetallicRoughness.baseColorFactor = {color.x, color.y, color.z, 1};
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.6;
  material.doubleSided = true;
  model.materials.push_back(material);
  return static_cast<int>(model.materials.size()) - 1;
}

/// q and -q turn alike; a viewer that interpolates needs neighbours on the same side.
std::vector<float> continuousRotations(const std::vector<std::array<double, 4>>& rotations) {
  std::vector<float> result;
  std::array<double, 4> before{1, 0, 0, 0};
  for (std::array<double, 4> q : rotations) {
    if (q[0] * before[0] + q[1] * before[1] + q[2] * before[2] + q[3] * before[3] < 0) {
      for (double& x : q) x = -x;
    }
    result.insert(result.end(), {float(q[1]), float(q[2]), float(q[3]), float(q[0])});  // glTF: x, y, z, w
    before = q;
  }
  return result;
}

void addTrack(tinygltf::Animation& animation, int node, const char* path, int times, int values,
              const char* interpolation = "LINEAR") {
  tinygltf::AnimationSampler sampler;
  sampler.input = times;
  sampler.output = values;
  sampler.interpolation = interpolation;
  animation.samplers.push_back(sampler);
  tinygltf::AnimationChannel channel;
  channel.sampler = static_cast<int>(animation.samplers.size()) - 1;
  channel.target_node = node;
  channel.target_path = path;
  animation.channels.push_back(channel);
}

struct MeshAccessors {
  int positions, normals, indices;
};

MeshAccessors addSurface(Writer& writer, const ShadedSurface& surface) {
  return {writer.addFloats(surface.positions, TINYGLTF_TYPE_VEC3, 3, TINYGLTF_TARGET_ARRAY_BUFFER, true),
          writer.addFloats(surface.normals, TINYGLTF_TYPE_VEC3, 3, TINYGLTF_TARGET_ARRAY_BUFFER, false),
          writer.addIndices(surface.indices)};
}

int addMesh(tinygltf::Model& model, const std::string& name, const MeshAccessors& arrays, int material) {
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes["POSITION"] = arrays.positions;
  primitive.attributes["NORMAL"] = arrays.normals;
  primitive.indices = arrays.indices;
  primitive.material = material;
  tinygltf::Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(primitive);
  model.meshes.push_back(mesh);
  return static_cast<int>(model.meshes.size()) - 1;
}

int addNode(tinygltf::Model& model, const tinygltf::Node& node) {
  model.nodes.push_back(node);
  const int index = static_cast<int>(model.nodes.size()) - 1;
  model.nodes[0].children.push_back(index);
  return index;
}

std::vector<double> gltfRotation(const std::array<double, 4>& q) {
  return {q[1], q[2], q[3], q[0]};
}

/// The rotation that turns z to the direction.
std::array<double, 4> rotationFromZ(const Vec3d& direction) {
  if (direction.z < -0.9999999) return {0, 1, 0, 0};
  const double w = std::sqrt(0.5 * (1 + direction.z));
  return {w, -direction.y / (2 * w), direction.x / (2 * w), 0};
}

/// glTF's cameras and spot lights look along their own -z, with y up.
std::array<double, 4> rotationThatLooks(const Vec3d& direction) {
  const Vec3d back = unit(direction) * -1.0;
  const Vec3d right = unit(otgCross(Vec3d{0, 0, 1}, back)), up = otgCross(back, right);
  dMatrix3 m = {right.x, up.x, back.x, 0, right.y, up.y, back.y, 0, right.z, up.z, back.z, 0};
  dQuaternion q;
  dRtoQ(m, q);
  return {q[0], q[1], q[2], q[3]};
}

void addBodies(Writer& writer, tinygltf::Animation& animation, const Recording& recording, int times) {
  tinygltf::Model& model = writer.model();
  std::map<const TriMesh*, MeshAccessors> shared;
  for (const AnimatedBody& body : recording.bodies) {
    if (body.surface->triangleCount() == 0 || body.positions.empty()) continue;
    auto found = shared.find(body.surface.get());
    if (found == shared.end()) {
      found = shared.emplace(body.surface.get(), addSurface(writer, shade(*body.surface))).first;
    }
    tinygltf::Node node;
    node.name = body.name;
    node.mesh = addMesh(model, body.name, found->second, addMaterial(model, body.color));
    const Vec3d& p = body.positions.front();
    node.translation = {p.x, p.y, p.z};
    node.rotation = gltfRotation(body.rotations.front());
    const int index = addNode(model, node);
    if (times < 0 || body.positions.size() != recording.times.size()) continue;
    std::vector<float> translations;
    for (const Vec3d& x : body.positions) translations.insert(translations.end(), {float(x.x), float(x.y), float(x.z)});
    addTrack(animation, index, "translation", times, writer.addFloats(translations, TINYGLTF_TYPE_VEC3, 3, 0, false));
    addTrack(animation, index, "rotation", times,
             writer.addFloats(continuousRotations(body.rotations), TINYGLTF_TYPE_VEC4, 4, 0, false));
  }
}

/// An arrow from the origin to (0, 0, 1): a shaft and a tip, closed.
ShadedSurface arrowSurface() {
  constexpr int kSides = 8;
  constexpr double kShaft = 0.035, kTip = 0.09, kNeck = 0.68;
  ShadedSurface arrow;
  const auto ring = [&](double radius, double z, double slope) {
    for (int i = 0; i < kSides; ++i) {
      const double angle = 2 * 3.14159265358979323846 * i / kSides, c = std::cos(angle), s = std::sin(angle);
      arrow.positions.insert(arrow.positions.end(), {float(radius * c), float(radius * s), float(z)});
      const Vec3d n = unit(Vec3d{c, s, slope});
      arrow.normals.insert(arrow.normals.end(), {float(n.x), float(n.y), float(n.z)});
    }
  };
  ring(0, 0, -1e9);
  ring(kShaft, 0, -1);
  ring(kShaft, kNeck, 0);
  ring(kTip, kNeck, 0);
  ring(0, 1, kTip / (1 - kNeck));
  for (std::uint32_t r = 0; r + 1 < 5; ++r) {
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const std::uint32_t a = r * kSides + i, b = r * kSides + (i + 1) % kSides;
      if (r > 0) arrow.indices.insert(arrow.indices.end(), {a, b, a + kSides});
      if (r < 3) arrow.indices.insert(arrow.indices.end(), {b, b + kSides, a + kSides});
    }
  }
  return arrow;
}

/// As many arrows of each colour as the fullest frame has. An arrow that a frame has no use for is scaled to nothing.
void addArrows(Writer& writer, tinygltf::Animation& animation, const Recording& recording, int times) {
  if (times < 0) return;
  const double usual = usualDepth(recording), length = 0.2 * findStage(recording.bodies).radius;
  std::vector<std::vector<const ContactArrow*>> frames(recording.times.size());
  int accessorsMade = 0;
  MeshAccessors arrays{};
  for (std::size_t color = 0; color < kDepthColors.size(); ++color) {
    std::size_t most = 0;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      frames[f].clear();
      for (const ContactArrow& arrow : recording.contacts[f]) {
        if (depthColor(arrow.depth, usual) == color) frames[f].push_back(&arrow);
      }
      most = std::max(most, frames[f].size());
    }
    if (most == 0) continue;
    if (accessorsMade++ == 0) arrays = addSurface(writer, arrowSurface());
    const std::string name = "contact " + std::to_string(color);
    const int mesh = addMesh(writer.model(), name, arrays, addMaterial(writer.model(), kDepthColors[color]));
    for (std::size_t k = 0; k < most; ++k) {
      std::vector<float> places, turns, scales;
      for (const auto& frame : frames) {
        const ContactArrow nothing{};
        const ContactArrow& arrow = k < frame.size() ? *frame[k] : nothing;
        const auto scale = float(k < frame.size() ? length : 0);
        const auto q = rotationFromZ(arrow.direction);
        places.insert(places.end(), {float(arrow.position.x), float(arrow.position.y), float(arrow.position.z)});
        turns.insert(turns.end(), {float(q[1]), float(q[2]), float(q[3]), float(q[0])});
        scales.insert(scales.end(), {scale, scale, scale});
      }
      tinygltf::Node node;
      node.name = name;
      node.mesh = mesh;
      node.scale = {0, 0, 0};
      const int index = addNode(writer.model(), node);
      addTrack(animation, index, "translation", times, writer.addFloats(places, TINYGLTF_TYPE_VEC3, 3, 0, false),
               "STEP");
      addTrack(animation, index, "rotation", times, writer.addFloats(turns, TINYGLTF_TYPE_VEC4, 4, 0, false), "STEP");
      addTrack(animation, index, "scale", times, writer.addFloats(scales, TINYGLTF_TYPE_VEC3, 3, 0, false), "STEP");
    }
  }
}

void addCamera(tinygltf::Model& model, const Stage& stage) {
  tinygltf::Camera camera;
  camera.name = "camera";
  camera.type = "perspective";
  camera.perspective.yfov = 0.8;
  camera.perspective.aspectRatio = 16.0 / 9;
  camera.perspective.znear = 0.01 * stage.radius;
  camera.perspective.zfar = 100 * stage.radius;
  model.cameras.push_back(camera);
  const Vec3d from = kViewFrom * (2.6 * stage.radius);
  tinygltf::Node node;
  node.name = "camera";
  node.camera = 0;
  node.translation = {stage.center.x + from.x, stage.center.y + from.y, stage.center.z + from.z};
  node.rotation = gltfRotation(rotationThatLooks(from * -1.0));
  addNode(model, node);
}

/// A sun and a weaker light from the other side: a directional light shines wherever its node is.
void addLights(tinygltf::Model& model) {
  const struct {
    const char* name;
    Vec3d from;
    std::vector<double> color;
    double lux;
  } lights[] = {{"sun", {-0.5, -0.4, 0.8}, {1, 0.95, 0.85}, 3}, {"sky", {0.6, 0.3, 0.5}, {0.8, 0.9, 1}, 1}};
  for (const auto& shining : lights) {
    tinygltf::Light light;
    light.name = shining.name;
    light.type = "directional";
    light.color = shining.color;
    light.intensity = shining.lux;
    model.lights.push_back(light);
    tinygltf::Node node;
    node.name = shining.name;
    node.rotation = gltfRotation(rotationThatLooks(shining.from * -1.0));
    tinygltf::Value::Object reference;
    reference["light"] = tinygltf::Value(static_cast<int>(model.lights.size()) - 1);
    node.extensions["KHR_lights_punctual"] = tinygltf::Value(reference);
    addNode(model, node);
  }
}

}  // namespace

void writeGlb(const std::string& path, const Recording& recording) {
  Writer writer;
  tinygltf::Model& model = writer.model();
  tinygltf::Animation animation;
  animation.name = "simulation";
  int times = -1;
  if (recording.times.size() > 1) {
    const std::vector<float> seconds(recording.times.begin(), recording.times.end());
    times = writer.addFloats(seconds, TINYGLTF_TYPE_SCALAR, 1, 0, true);
  }
  tinygltf::Node root;
  root.name = "world";
  root.rotation = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  model.nodes.push_back(root);
  addBodies(writer, animation, recording, times);
  addArrows(writer, animation, recording, times);
  addCamera(model, findStage(recording.bodies));
  addLights(model);
  if (!animation.channels.empty()) model.animations.push_back(animation);
  tinygltf::Scene scene;
  scene.nodes.push_back(0);
  model.scenes.push_back(scene);
  model.defaultScene = 0;
  model.asset.version = "2.0";
  model.asset.generator = "ode_trimesh_gpu";
  std::ofstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path + ": cannot be written");
  tinygltf::TinyGLTF gltf;
  if (!gltf.WriteGltfSceneToStream(&model, stream, false, true) || !stream.flush()) {
    throw std::runtime_error(path + ": writing failed");
  }
}

}  // namespace otg::scenes
