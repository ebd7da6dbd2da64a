// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_io/gltf_check.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

namespace otg::mesh_io {
namespace {

using nlohmann::json;

constexpr int kMostJsonLevels = 64;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error("glTF: " + what);
}

std::uint32_t word(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// The two parts of a binary file; of a text file the first is all of it.
struct Chunks {
  std::string_view text;
  std::size_t binary = 0;  ///< bytes
};

Chunks chunksOf(std::string_view bytes) {
  if (bytes.substr(0, 4) != "glTF") return {bytes, 0};
  if (bytes.size() < 20) fail("the file is cut off");
  if (word(bytes, 4) != 2) fail("only version 2.0 is read");
  const std::uint32_t size = word(bytes, 12);
  if (word(bytes, 16) != kJsonChunk || size > bytes.size() - 20) fail("the file is cut off");
  Chunks chunks{bytes.substr(20, size), 0};
  const std::string_view rest = bytes.substr(20 + std::size_t{size});
  if (rest.size() < 8) return chunks;
  if (word(rest, 4) == kBinaryChunk) chunks.binary = std::min<std::size_t>(word(rest, 0), rest.size() - 8);
  return chunks;
}

/// Readers of JSON may call themselves for each level.
void checkJsonLevels(std::string_view text) {
  int level = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') quoted = !quoted;
    if (quoted && c == '\\') ++i;  // whatever it is, it does not end the string
    if (quoted) continue;
    level += (c == '[' || c == '{') - (c == ']' || c == '}');
    if (level > kMostJsonLevels) fail("objects and arrays lie more than 64 levels deep in each other");
  }
}

json parse(std::string_view text) {
  checkJsonLevels(text);
  try {
    return json::parse(text);
  } catch (const json::exception& error) {
    fail(std::string("not valid JSON: ") + error.what());
  }
}

class GltfCheck {
 public:
  GltfCheck(const json& document, std::size_t binary, const std::string& folder)
      : document_(document), binary_(binary), folder_(folder) {}

  void run() {
    if (!document_.is_object()) fail("not an object");
    const json& asset = member(document_, "asset");
    const json& version = member(asset, "version");
    if (!version.is_string() || version.get<std::string>().substr(0, 2) != "2.") fail("only version 2.0 is read");
    buffers();
    views();
    accessors();
    meshes();
    nodes();
    scenes();
  }

 private:
  static const json& member(const json& object, const char* key) {
    static const json none;
    if (!object.is_object()) return none;
    const auto found = object.find(key);
    return found == object.end() ? none : *found;
  }
  const json& list(const char* key) const {
    static const json empty = json::array();
    const json& value = member(document_, key);
    if (value.is_null()) return empty;
    if (!value.is_array()) fail(std::string(key) + " is no array");
    return value;
  }
  /// A whole number from 0; what is missing counts as `fallback`.
  static std::uint64_t count(const json& object, const char* key, const std::string& where, std::uint64_t fallback) {
    const json& value = member(object, key);
    if (value.is_null()) return fallback;
    if (!value.is_number_unsigned()) fail(where + ": '" + key + "' is no whole number from 0");
    return value.get<std::uint64_t>();
  }
  /// The number of one of `size` things.
  static std::size_t index(const json& value, std::size_t size, const std::string& where) {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= size) {
      fail(where + " names something that is not there");
    }
    return static_cast<std::size_t>(value.get<std::uint64_t>());
  }
  static std::string numbered(const char* what, std::size_t i) { return std::string(what) + " " + std::to_string(i); }

  void buffers() {
    for (const json& buffer : list("buffers")) {
      const std::string where = numbered("buffer", buffers_.size());
      const std::uint64_t length = count(buffer, "byteLength", where, 0);
      const json& uri = member(buffer, "uri");
      if (length > roomOf(uri, where)) fail(where + " is longer than its data");
      buffers_.push_back(length);
      bytes_ += static_cast<double>(length);
    }
  }
  std::uint64_t roomOf(const json& uri, const std::string& where) const {
    if (uri.is_null()) {
      if (!buffers_.empty() || binary_ == 0) fail(where + " has no data");
      return binary_;
    }
    if (!uri.is_string()) fail(where + ": 'uri' is no text");
    const auto& name = uri.get_ref<const std::string&>();
    if (name.substr(0, 5) == "data:") return name.size();  // base64 has fewer bytes than letters
    std::error_code error;
    const std::filesystem::path path = std::filesystem::path(folder_) / unescaped(name);
    if (!std::filesystem::is_regular_file(path, error)) fail(where + ": there is no file '" + name + "'");
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    return error ? 0 : size;
  }
  /// "%20" is a space in an address.
  static std::string unescaped(const std::string& name) {
    std::string text;
    for (std::size_t i = 0; i < name.size(); ++i) {
      unsigned char code = 0;
      const char* const digits = name.data() + i + 1;
      if (name[i] == '%' && i + 2 < name.size() && std::isxdigit(static_cast<unsigned char>(digits[0])) != 0 &&
          std::isxdigit(static_cast<unsigned char>(digits[1])) != 0) {
        code = static_cast<unsigned char>(std::stoi(name.substr(i + 1, 2), nullptr, 16));
        i += 2;
      }
      text += code != 0 ? static_cast<char>(code) : name[i];
    }
    return text;
  }

  void views() {
    for (const json& view : list("bufferViews")) {
      const std::string where = numbered("bufferView", views_.size());
      const std::size_t buffer = index(member(view, "buffer"), buffers_.size(), where);
      const std::uint64_t length = count(view, "byteLength", where, 0), offset = count(view, "byteOffset", where, 0);
      if (length == 0 || length > buffers_[buffer] || offset > buffers_[buffer] - length) {
        fail(where + " is not in its buffer");
      }
      views_.push_back(length);
      strides_.push_back(count(view, "byteStride", where, 0));
    }
  }

  static std::uint64_t bytesOf(const json& componentType) {
    if (!componentType.is_number_integer()) return 0;
    switch (componentType.get<int>()) {
      case 5120:
      case 5121:
        return 1;
      case 5122:
      case 5123:
        return 2;
      case 5125:
      case 5126:
        return 4;
      default:
        return 0;
    }
  }
  static std::uint64_t componentsOf(const json& type) {
    static constexpr struct {
      const char* name;
      std::uint64_t count;
    } kTypes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
    for (const auto& known : kTypes) {
      if (type == known.name) return known.count;
    }
    return 0;
  }
  void accessors() {
    for (const json& accessor : list("accessors")) {
      const std::string where = numbered("accessor", accessors_.size());
      const std::uint64_t elements = count(accessor, "count", where, 0),
                          offset = count(accessor, "byteOffset", where, 0);
      const std::uint64_t size = bytesOf(member(accessor, "componentType")) * componentsOf(member(accessor, "type"));
      if (size == 0) fail(where + " has an unknown type");
      if (!member(accessor, "sparse").is_null()) fail(where + " is sparse, which is not read");
      const json& named = member(accessor, "bufferView");
      if (named.is_null()) fail(where + " has no bufferView");
      const std::size_t view = index(named, views_.size(), where);
      const std::uint64_t stride = std::max(size, strides_[view]);
      // The last element need not fill its stride.
      if (elements > 0 && (offset > views_[view] || size > views_[view] - offset ||
                           elements - 1 > (views_[view] - offset - size) / stride)) {
        fail(where + " is not in its bufferView");
      }
      accessors_.push_back(static_cast<double>(elements));
    }
  }

  void meshes() {
    double all = 0;
    for (const json& mesh : list("meshes")) {
      const std::string where = numbered("mesh", meshes_.size());
      double size = 0;
      const auto add = [&](const json& accessor) { size += accessors_[index(accessor, accessors_.size(), where)]; };
      const json& primitives = member(mesh, "primitives");
      if (!primitives.is_array()) fail(where + " has no primitives");
      for (const json& primitive : primitives) {
        size += 1;
        const json& attributes = member(primitive, "attributes");
        if (attributes.is_object()) {
          for (const json& attribute : attributes) add(attribute);
        }
        if (const json& indices = member(primitive, "indices"); !indices.is_null()) add(indices);
        const json& targets = member(primitive, "targets");
        if (!targets.is_array()) continue;
        for (const json& target : targets) {
          for (const json& attribute : target) add(attribute);
        }
      }
      meshes_.push_back(size);
      all += size;
    }
    if (all > bytes_ + kMostGltfRepeats) fail("its meshes use their numbers so often that they become " + shown(all));
  }

  void nodes() {
    const json& all = list("nodes");
    std::vector<std::size_t> parent(all.size(), all.size());
    double placed = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::string where = numbered("node", i);
      if (!all[i].is_object()) fail(where + " is no object");
      if (const json& mesh = member(all[i], "mesh"); !mesh.is_null()) {
        placed += meshes_[index(mesh, meshes_.size(), where)];
      }
      const json& children = member(all[i], "children");
      if (children.is_null()) continue;
      if (!children.is_array()) fail(where + ": 'children' is no array");
      for (const json& child : children) {
        const std::size_t c = index(child, all.size(), where);
        if (parent[c] != all.size()) fail(numbered("node", c) + " has more than one parent");
        parent[c] = i;
      }
    }
    if (placed > bytes_ + kMostGltfRepeats) fail("its meshes are placed so often that they become " + shown(placed));
    checkLevels(parent);
    nodeCount_ = all.size();
  }
  static std::string shown(double count) { return std::to_string(static_cast<std::uint64_t>(count)) + " numbers"; }

  /// With a parent each, nodes make trees and circles. Each node is looked at once: its level is one more than that of
  /// its parent.
  static void checkLevels(const std::vector<std::size_t>& parent) {
    const std::size_t none = parent.size();
    std::vector<int> level(parent.size(), 0);  // 0: not known yet, -1: on the way
    std::vector<std::size_t> way;
    for (std::size_t i = 0; i < parent.size(); ++i) {
      std::size_t n = i;
      for (; n != none && level[n] == 0; n = parent[n]) {
        level[n] = -1;
        way.push_back(n);
      }
      if (n != none && level[n] < 0) fail("nodes are each other's children, in a circle");
      int above = n == none ? 0 : level[n];
      for (; !way.empty(); way.pop_back()) {
        if (++above > kMostGltfLevels) fail("nodes lie more than 512 levels deep");
        level[way.back()] = above;
      }
    }
  }

  void scenes() const {
    const json& all = list("scenes");
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::string where = numbered("scene", i);
      const json& roots = member(all[i], "nodes");
      if (roots.is_null()) continue;
      if (!roots.is_array()) fail(where + ": 'nodes' is no array");
      std::vector<bool> seen(nodeCount_, false);
      for (const json& root : roots) {
        const std::size_t node = index(root, nodeCount_, where);
        if (seen[node]) fail(where + " has a node twice");
        seen[node] = true;
      }
    }
    if (const json& shown = member(document_, "scene"); !shown.is_null()) index(shown, all.size(), "the scene");
  }

  const json& document_;
  const std::size_t binary_;
  const std::string& folder_;
  std::vector<std::uint64_t> buffers_, views_, strides_;
  std::vector<double> accessors_, meshes_;  ///< elements; of meshes all that a copy of it has
  double bytes_ = 0;
  std::size_t nodeCount_ = 0;
};

}  // namespace

void checkGltf(std::string_view bytes, const std::string& folder) {
  const Chunks chunks = chunksOf(bytes);
  const json document = parse(chunks.text);
  GltfCheck(document, chunks.binary, folder).run();
}

}  // namespace otg::mesh_io
