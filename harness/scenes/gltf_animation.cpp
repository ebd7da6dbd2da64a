// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/gltf_animation.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <stdexcept>
#include <tuple>

#include "base/vectors.h"

namespace otg::scenes {
namespace {

/// Faces that meet under a smaller angle than this shade as one smooth surface.
constexpr double kCosCrease = 0.7660444431;  // 40 degrees

struct Shaded {
  std::vector<float> positions, normals;
  std::vector<std::uint32_t> indices;
};

Vec3d faceNormal(const TriMesh& mesh, const Triangle& t) {
  const auto corner = [&](int k) {
    const Vec3f v = mesh.vertices()[t.v[k]];
    return Vec3d{v.x, v.y, v.z};
  };
  return otgCross(corner(1) - corner(0), corner(2) - corner(0));  // length is twice the area
}

Vec3d unitOrUp(const Vec3d& v) {
  const double length = norm(v);
  return length > 0 ? v * (1 / length) : Vec3d{0, 0, 1};
}

/// Corner normals: the area-weighted mean over the faces around the (welded) vertex that lie within the crease angle.
Shaded shade(const TriMesh& mesh) {
  const auto triangles = mesh.triangles();
  const auto& weld = mesh.topology().weld;
  std::vector<Vec3d> faces;
  std::vector<std::uint32_t> start(mesh.vertices().size() + 1, 0), around;
  for (const Triangle& t : triangles) {
    faces.push_back(faceNormal(mesh, t));
    for (const std::uint32_t v : t.v) ++start[weld[v] + 1];
  }
  for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  around.resize(start.back());
  std::vector<std::uint32_t> fill(start.begin(), start.end() - 1);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : triangles[t].v) around[fill[weld[v]]++] = t;
  }
  Shaded result;
  std::map<std::tuple<std::uint32_t, float, float, float>, std::uint32_t> seen;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Vec3d own = unitOrUp(faces[t]);
    for (const std::uint32_t vertex : triangles[t].v) {
      const std::uint32_t v = weld[vertex];
      Vec3d sum{0, 0, 0};
      for (std::uint32_t i = start[v]; i < start[v + 1]; ++i) {
        if (otgDot(unitOrUp(faces[around[i]]), own) >= kCosCrease) sum = sum + faces[around[i]];
      }
      const Vec3d n = unitOrUp(sum);
      const float x = float(n.x), y = float(n.y), z = float(n.z);
      const auto [entry, isNew] =
          seen.try_emplace({v, x, y, z}, static_cast<std::uint32_t>(result.positions.size() / 3));
      if (isNew) {
        const Vec3f p = mesh.vertices()[v];
        result.positions.insert(result.positions.end(), {p.x, p.y, p.z});
        result.normals.insert(result.normals.end(), {x, y, z});
      }
      result.indices.push_back(entry->second);
    }
  }
  return result;
}

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

void addTrack(tinygltf::Animation& animation, int node, const char* path, int times, int values) {
  tinygltf::AnimationSampler sampler;
  sampler.input = times;
  sampler.output = values;
  sampler.interpolation = "LINEAR";
  animation.samplers.push_back(sampler);
  tinygltf::AnimationChannel channel;
  channel.sampler = static_cast<int>(animation.samplers.size()) - 1;
  channel.target_node = node;
  channel.target_path = path;
  animation.channels.push_back(channel);
}

}  // namespace

void writeGlb(const std::string& path, const std::vector<AnimatedBody>& bodies, const std::vector<double>& times) {
  Writer writer;
  tinygltf::Model& model = writer.model();
  tinygltf::Animation animation;
  animation.name = "simulation";
  int timeAccessor = -1;
  if (times.size() > 1) {
    const std::vector<float> seconds(times.begin(), times.end());
    timeAccessor = writer.addFloats(seconds, TINYGLTF_TYPE_SCALAR, 1, 0, true);
  }
  tinygltf::Node root;
  root.name = "world";
  root.rotation = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  model.nodes.push_back(root);
  struct Arrays {
    int positions, normals, indices;
  };
  std::map<const TriMesh*, Arrays> shared;
  for (const AnimatedBody& body : bodies) {
    if (body.surface->triangleCount() == 0 || body.positions.empty()) continue;
    auto found = shared.find(body.surface.get());
    if (found == shared.end()) {
      const Shaded shaded = shade(*body.surface);
      const Arrays arrays{writer.addFloats(shaded.positions, TINYGLTF_TYPE_VEC3, 3, TINYGLTF_TARGET_ARRAY_BUFFER, true),
                          writer.addFloats(shaded.normals, TINYGLTF_TYPE_VEC3, 3, TINYGLTF_TARGET_ARRAY_BUFFER, false),
                          writer.addIndices(shaded.indices)};
      found = shared.emplace(body.surface.get(), arrays).first;
    }
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.attributes["POSITION"] = found->second.positions;
    primitive.attributes["NORMAL"] = found->second.normals;
    primitive.indices = found->second.indices;
    primitive.material = addMaterial(model, body.color);
    tinygltf::Mesh mesh;
    mesh.name = body.name;
    mesh.primitives.push_back(primitive);
    model.meshes.push_back(mesh);
    tinygltf::Node node;
    node.name = body.name;
    node.mesh = static_cast<int>(model.meshes.size()) - 1;
    const Vec3d& p = body.positions.front();
    const auto& q = body.rotations.front();
    node.translation = {p.x, p.y, p.z};
    node.rotation = {q[1], q[2], q[3], q[0]};
    model.nodes.push_back(node);
    const int index = static_cast<int>(model.nodes.size()) - 1;
    model.nodes[0].children.push_back(index);
    if (timeAccessor < 0 || body.positions.size() != times.size()) continue;
    std::vector<float> translations;
    for (const Vec3d& x : body.positions) translations.insert(translations.end(), {float(x.x), float(x.y), float(x.z)});
    addTrack(animation, index, "translation", timeAccessor,
             writer.addFloats(translations, TINYGLTF_TYPE_VEC3, 3, 0, false));
    addTrack(animation, index, "rotation", timeAccessor,
             writer.addFloats(continuousRotations(body.rotations), TINYGLTF_TYPE_VEC4, 4, 0, false));
  }
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
