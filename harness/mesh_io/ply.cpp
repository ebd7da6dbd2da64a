// SPDX-License-Identifier: BSD-3-Clause
// PLY: text, binary little endian, binary big endian; any elements and properties around the ones that we need.
#include <bit>
#include <cstring>
#include <optional>
#include <vector>

#include "mesh_io/readers.h"
#include "mesh_io/text.h"

namespace otg::mesh_io {
namespace {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
enum class Format { kText, kLittle, kBig };

struct Property {
  std::string name;
  Type type;
  std::optional<Type> listCount;  ///< type of the count in front of a list
};

struct Element {
  std::string name;
  std::uint64_t count;
  std::vector<Property> properties;
};

Type parseType(std::string_view word) {
  static constexpr struct {
    std::string_view name;
    Type type;
  } kNames[] = {
      {"char", Type::kInt8},     {"int8", Type::kInt8},       {"uchar", Type::kUint8},    {"uint8", Type::kUint8},
      {"short", Type::kInt16},   {"int16", Type::kInt16},     {"ushort", Type::kUint16},  {"uint16", Type::kUint16},
      {"int", Type::kInt32},     {"int32", Type::kInt32},     {"uint", Type::kUint32},    {"uint32", Type::kUint32},
      {"float", Type::kFloat32}, {"float32", Type::kFloat32}, {"double", Type::kFloat64}, {"float64", Type::kFloat64}};
  for (const auto& entry : kNames) {
    if (entry.name == word) return entry.type;
  }
  throw std::runtime_error("unknown property type " + quoted(word) + " in the PLY header");
}

std::size_t sizeOf(Type type) {
  static constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<int>(type)];
}

bool isReal(Type type) {
  return type == Type::kFloat32 || type == Type::kFloat64;
}

/// Hands out the numbers of the body, whatever their encoding.
class Body {
 public:
  Body(std::string_view bytes, Format format) : rest_(bytes), format_(format) {}

  double takeReal(Type type) {
    if (format_ == Format::kText) return parseReal(takeToken());
    switch (type) {
      case Type::kFloat32:
        return take<float>();
      case Type::kFloat64:
        return take<double>();
      default:
        return static_cast<double>(takeInteger(type));
    }
  }

  std::int64_t takeInteger(Type type) {
    if (format_ == Format::kText) return parseInteger(takeToken());
    switch (type) {
      case Type::kInt8:
        return take<std::int8_t>();
      case Type::kUint8:
        return take<std::uint8_t>();
      case Type::kInt16:
        return take<std::int16_t>();
      case Type::kUint16:
        return take<std::uint16_t>();
      case Type::kInt32:
        return take<std::int32_t>();
      case Type::kUint32:
        return take<std::uint32_t>();
      default:
        throw std::runtime_error("the PLY header declares a list count or an index as a real number");
    }
  }

  void skip(Type type) {
    if (format_ == Format::kText) {
      takeToken();
    } else {
      need(sizeOf(type));
      rest_.remove_prefix(sizeOf(type));
    }
  }

  std::size_t bytesLeft() const { return rest_.size(); }

 private:
  void need(std::size_t count) const {
    if (rest_.size() < count) throw std::runtime_error("the file is cut off");
  }

  template <class T>
  T take() {
    need(sizeof(T));
    char raw[sizeof(T)];
    std::memcpy(raw, rest_.data(), sizeof(T));
    rest_.remove_prefix(sizeof(T));
    if ((format_ == Format::kBig) != (std::endian::native == std::endian::big)) {
      for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(raw[i], raw[sizeof(T) - 1 - i]);
    }
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }

  std::string_view takeToken() {
    while (!rest_.empty() && (isBlank(rest_.front()) || rest_.front() == '\n')) rest_.remove_prefix(1);
    if (rest_.empty()) throw std::runtime_error("the file is cut off");
    std::size_t end = 0;
    while (end < rest_.size() && !isBlank(rest_[end]) && rest_[end] != '\n') ++end;
    const std::string_view token = rest_.substr(0, end);
    rest_.remove_prefix(end);
    return token;
  }

  std::string_view rest_;
  Format format_;
};

struct Header {
  Format format = Format::kText;
  std::vector<Element> elements;
};

Header readHeader(std::string_view& rest) {
  std::string_view line;
  if (!takeLine(rest, line) || takeWord(line) != "ply") {
    throw std::runtime_error("not a PLY file: it does not start with 'ply'");
  }
  Header header;
  bool hasFormat = false;
  while (true) {
    if (!takeLine(rest, line)) throw std::runtime_error("the PLY header has no end_header");
    const std::string_view word = takeWord(line);
    if (word == "end_header") break;
    if (word.empty() || word == "comment" || word == "obj_info") continue;
    if (word == "format") {
      const std::string_view name = takeWord(line);
      if (name == "ascii")
        header.format = Format::kText;
      else if (name == "binary_little_endian")
        header.format = Format::kLittle;
      else if (name == "binary_big_endian")
        header.format = Format::kBig;
      else
        throw std::runtime_error("unknown PLY format " + quoted(name));
      hasFormat = true;
    } else if (word == "element") {
      const std::string name(takeWord(line));
      const std::int64_t count = parseInteger(takeWord(line));
      if (count < 0) throw std::runtime_error("the PLY header gives a negative count of '" + name + "'");
      header.elements.push_back({name, static_cast<std::uint64_t>(count), {}});
    } else if (word == "property") {
      if (header.elements.empty()) throw std::runtime_error("a property before any element in the PLY header");
      Property property;
      std::string_view type = takeWord(line);
      if (type == "list") {
        property.listCount = parseType(takeWord(line));
        type = takeWord(line);
      }
      property.type = parseType(type);
      property.name = std::string(takeWord(line));
      header.elements.back().properties.push_back(property);
    } else {
      throw std::runtime_error("unknown word " + quoted(word) + " in the PLY header");
    }
  }
  if (!hasFormat) throw std::runtime_error("the PLY header has no format line");
  return header;
}

std::size_t findProperty(const Element& element, std::string_view name) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    if (element.properties[i].name == name) return i;
  }
  return element.properties.size();
}

/// A count that the rest of the file cannot hold is found before memory is allocated for it.
void checkRoom(const Element& element, const Body& body, Format format) {
  std::uint64_t smallest = 0;
  for (const Property& property : element.properties) {
    smallest += format == Format::kText ? 2 : sizeOf(property.listCount ? *property.listCount : property.type);
  }
  if (smallest == 0) return;
  // In text the last number may lack the white space after it.
  if (element.count > (body.bytesLeft() + 1) / smallest) {
    throw std::runtime_error("the file is cut off: its header announces " + std::to_string(element.count) + " of '" +
                             element.name + "', but only " + std::to_string(body.bytesLeft()) + " bytes follow");
  }
}

void readVertices(const Element& element, Body& body, MeshFile& mesh) {
  const std::size_t x = findProperty(element, "x"), y = findProperty(element, "y"), z = findProperty(element, "z");
  const std::size_t none = element.properties.size();
  if (x == none || y == none || z == none) throw std::runtime_error("the PLY vertices lack x, y or z");
  for (const std::size_t i : {x, y, z}) {
    if (element.properties[i].listCount) throw std::runtime_error("x, y or z of the PLY vertices is a list");
  }
  mesh.vertices.resize(element.count);
  for (Vec3d& vertex : mesh.vertices) {
    for (std::size_t i = 0; i < none; ++i) {
      const Property& property = element.properties[i];
      if (i == x) {
        vertex.x = body.takeReal(property.type);
      } else if (i == y) {
        vertex.y = body.takeReal(property.type);
      } else if (i == z) {
        vertex.z = body.takeReal(property.type);
      } else {
        const std::int64_t count = property.listCount ? body.takeInteger(*property.listCount) : 1;
        for (std::int64_t k = 0; k < count; ++k) body.skip(property.type);
      }
    }
  }
}

void readFaces(const Element& element, Body& body, MeshFile& mesh) {
  std::size_t corners = findProperty(element, "vertex_indices");
  if (corners == element.properties.size()) corners = findProperty(element, "vertex_index");
  if (corners == element.properties.size() || !element.properties[corners].listCount) {
    throw std::runtime_error("the PLY faces have no list 'vertex_indices'");
  }
  if (isReal(element.properties[corners].type)) throw std::runtime_error("the PLY face indices are real numbers");
  mesh.triangles.reserve(element.count);
  for (std::uint64_t face = 0; face < element.count; ++face) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Property& property = element.properties[i];
      const std::int64_t count = property.listCount ? body.takeInteger(*property.listCount) : 1;
      if (i != corners) {
        for (std::int64_t k = 0; k < count; ++k) body.skip(property.type);
        continue;
      }
      if (count < 3) {
        throw std::runtime_error("face " + std::to_string(face) + " has " + std::to_string(count) + " corners");
      }
      const std::uint32_t first = toIndex(body.takeInteger(property.type));
      std::uint32_t before = toIndex(body.takeInteger(property.type));
      for (std::int64_t k = 2; k < count; ++k) {
        const std::uint32_t current = toIndex(body.takeInteger(property.type));
        mesh.triangles.push_back({{first, before, current}});
        before = current;
      }
    }
  }
}

void skipElement(const Element& element, Body& body) {
  if (element.properties.empty()) return;  // however many there are, they take no room
  for (std::uint64_t n = 0; n < element.count; ++n) {
    for (const Property& property : element.properties) {
      const std::int64_t count = property.listCount ? body.takeInteger(*property.listCount) : 1;
      for (std::int64_t k = 0; k < count; ++k) body.skip(property.type);
    }
  }
}

}  // namespace

MeshFile readPly(std::string_view bytes) {
  const Header header = readHeader(bytes);
  Body body(bytes, header.format);
  MeshFile mesh;
  bool hasVertices = false;
  for (const Element& element : header.elements) {
    checkRoom(element, body, header.format);
    try {
      if (element.name == "vertex") {
        readVertices(element, body, mesh);
        hasVertices = true;
      } else if (element.name == "face") {
        readFaces(element, body, mesh);
      } else if (element.name == "tristrips") {
        throw std::runtime_error("triangle strips are not supported");
      } else {
        skipElement(element, body);
      }
    } catch (const std::runtime_error& error) {
      throw std::runtime_error("in the PLY element '" + element.name + "': " + error.what());
    }
  }
  if (!hasVertices) throw std::runtime_error("the PLY file has no vertices");
  return mesh;
}

}  // namespace otg::mesh_io
