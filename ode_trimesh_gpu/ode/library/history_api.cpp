// SPDX-License-Identifier: BSD-3-Clause
// Pair histories as bytes: written and read number by number, little end first, so that neither the machine nor the
// compiler shows in them.
//
//   8  "OTGHIST" and a zero byte
//   4  version
//   4  number of geoms, 4 number of pairs
//   for each pair, oldest query first within the geom that remembers it:
//     4  kind: 0 two meshes, 1 a mesh and a geom of ODE's own
//     4  place of the other geom (of two meshes the older one), 4 of the mesh that remembers
//     4  whether the mesh that remembers is mesh A of the query
//     3 x 8  origin of the frame that the states are given in, in the other geom's own (ode/shapes/primitive_history.h)
//     twice (before and current) a state: escape 3 x 8, escapeLeft 4, clampLeft 4, deepNormal 3 x 8, pose 12 x 8, 4
//     hasPose, 4 isJammed, side 4, front 3 x 8, deepest 8, content 8
//   8  FNV-1a of all that
#include "ode_trimesh_gpu/history.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <unordered_map>
#include <vector>

#include "base/hash.h"
#include "ode/base/status.h"
#include "ode/geom/mesh_side.h"
#include "ode/pairs/kept_pairs.h"
#include "ode/shapes/kept_shapes.h"
#include "ode/shapes/primitive_history.h"

namespace otg {
namespace {

enum : std::uint32_t { kTwoMeshes = 0, kWithOde = 1 };
constexpr std::uint64_t kNobody = ~std::uint64_t{0};  ///< no serial number and no address
constexpr char kMagic[8] = "OTGHIST";
constexpr std::uint32_t kVersion = 6;
// Whoever adds to what is remembered must write it, too, and raise the version.
static_assert(sizeof(SolidHistory::State) == 3 * 8 + 2 * 4 + 3 * 8 + 12 * 8 + 8 + 3 * 8 + 2 * 8);

class Writer {
 public:
  void integer(std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) out_.push_back(static_cast<unsigned char>(value >> (8 * i)));
  }
  void number(double value) { integer(std::bit_cast<std::uint64_t>(value), 8); }
  void vector(const Vec3d& v) {
    for (const double x : {v.x, v.y, v.z}) number(x);
  }
  void state(const SolidHistory::State& s) {
    vector(s.escape);
    integer(static_cast<std::uint32_t>(s.escapeLeft), 4);
    integer(static_cast<std::uint32_t>(s.clampLeft), 4);
    vector(s.deepNormal);
    for (const double r : s.pose.r) number(r);
    vector(s.pose.t);
    integer(s.hasPose ? 1 : 0, 4);
    integer(s.isJammed ? 1 : 0, 4);
    integer(static_cast<std::uint32_t>(s.side + 1), 4);
    vector(s.front);
    number(s.deepest);
    integer(s.content, 8);
  }
  std::vector<unsigned char>& bytes() { return out_; }

 private:
  std::vector<unsigned char> out_;
};

/// Reads what is there; good() turns false for good at the first thing that is not as it must be.
class Reader {
 public:
  Reader(const unsigned char* bytes, std::size_t size) : at_(bytes), left_(size) {}
  bool good() const { return good_; }
  bool atEnd() const { return left_ == 0; }
  std::uint64_t integer(int bytes) {
    if (left_ < static_cast<std::size_t>(bytes)) {
      good_ = false;
      left_ = 0;
      return 0;
    }
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) value |= std::uint64_t{at_[i]} << (8 * i);
    at_ += bytes;
    left_ -= static_cast<std::size_t>(bytes);
    return value;
  }
  /// 0 to `most`.
  int count(int most) {
    const std::uint64_t value = integer(4);
    good_ = good_ && value <= static_cast<std::uint64_t>(most);
    return good_ ? static_cast<int>(value) : 0;
  }
  double number() {
    const auto value = std::bit_cast<double>(integer(8));
    good_ = good_ && std::isfinite(value);
    return value;
  }
  Vec3d vector() {
    Vec3d v;
    for (double* x : {&v.x, &v.y, &v.z}) *x = number();
    return v;
  }
  SolidHistory::State state() {
    SolidHistory::State s;
    s.escape = vector();
    s.escapeLeft = count(SolidHistory::kEscapeQueries);
    s.clampLeft = count(SolidHistory::kClampQueries);
    s.deepNormal = vector();
    for (double& r : s.pose.r) r = number();
    s.pose.t = vector();
    s.hasPose = count(1) == 1;
    s.isJammed = count(1) == 1;
    s.side = count(2) - 1;
    s.front = vector();
    s.deepest = number();
    s.content = integer(8);
    return s;
  }

 private:
  const unsigned char* at_;
  std::size_t left_;
  bool good_ = true;
};

/// What is listed. A mesh has an object, and is known to others by its serial number; other geoms by their addresses.
struct Listed {
  std::vector<std::shared_ptr<GeomObject>> objects;
  std::vector<std::uint64_t> keys;  ///< 0 for NULL
  std::unordered_map<std::uint64_t, std::uint32_t> placeOf;
};

/// False for a list that is none.
bool readList(const dGeomID* geoms, int count, Listed& listed) {
  if (count < 0 || (count > 0 && geoms == nullptr)) return false;
  for (int i = 0; i < count; ++i) {
    listed.objects.push_back(geoms[i] == nullptr ? nullptr : settingsOf(geoms[i]));
    const std::shared_ptr<GeomObject>& object = listed.objects.back();
    // Serial numbers begin with 0.
    listed.keys.push_back(geoms[i] == nullptr ? kNobody : object != nullptr ? object->serial : memoryKey(geoms[i]));
    if (geoms[i] == nullptr) continue;
    if (!listed.placeOf.try_emplace(listed.keys.back(), static_cast<std::uint32_t>(i)).second) return false;
  }
  return true;
}

struct SavedPair {
  std::uint32_t other, mesh;
  PairMemory::Remembered remembered;
};

/// Whether the mesh at one place can remember a pair of this kind with the geom at the other.
bool isPair(const Listed& listed, std::uint32_t kind, std::uint32_t other, std::uint32_t mesh) {
  const std::size_t count = listed.objects.size();
  if (other >= count || mesh >= count || listed.objects[mesh] == nullptr || listed.keys[other] == kNobody) return false;
  const GeomObject* const object = listed.objects[other].get();
  return kind == kWithOde ? object == nullptr
                          : kind == kTwoMeshes && object != nullptr && object->serial < listed.objects[mesh]->serial;
}

/// False if the bytes are not what was saved, or do not fit the geoms.
bool parse(const unsigned char* bytes, std::size_t size, const Listed& listed, std::vector<SavedPair>& pairs) {
  if (bytes == nullptr || size < sizeof kMagic + 8 || std::memcmp(bytes, kMagic, sizeof kMagic) != 0) return false;
  Reader tail(bytes + size - 8, 8);
  if (tail.integer(8) != fnv1a(bytes, size - 8)) return false;
  Reader reader(bytes + sizeof kMagic, size - 8 - sizeof kMagic);
  if (reader.integer(4) != kVersion || reader.integer(4) != listed.objects.size()) return false;
  const std::uint64_t count = reader.integer(4);
  for (std::uint64_t i = 0; i < count && reader.good(); ++i) {
    SavedPair pair;
    const auto kind = static_cast<std::uint32_t>(reader.integer(4));
    pair.other = static_cast<std::uint32_t>(reader.integer(4));
    pair.mesh = static_cast<std::uint32_t>(reader.integer(4));
    if (!reader.good() || !isPair(listed, kind, pair.other, pair.mesh)) return false;
    pair.remembered.key = listed.keys[pair.other];
    pair.remembered.holderIsA = reader.count(1) == 1;
    pair.remembered.origin = reader.vector();
    pair.remembered.history.before = reader.state();
    pair.remembered.history.current = reader.state();
    pair.remembered.history.used = true;
    pairs.push_back(pair);
  }
  return reader.good() && reader.atEnd();
}

std::vector<unsigned char> serialize(const Listed& listed) {
  std::vector<SavedPair> pairs;
  for (std::uint32_t i = 0; i < listed.objects.size(); ++i) {
    if (listed.objects[i] == nullptr) continue;
    for (const PairMemory::Remembered& remembered : listed.objects[i]->memory.all()) {
      const auto place = listed.placeOf.find(remembered.key);
      if (place != listed.placeOf.end()) pairs.push_back({place->second, i, remembered});
    }
  }
  Writer writer;
  for (const char c : kMagic) writer.integer(static_cast<unsigned char>(c), 1);
  writer.integer(kVersion, 4);
  writer.integer(listed.objects.size(), 4);
  writer.integer(pairs.size(), 4);
  for (const SavedPair& pair : pairs) {
    writer.integer(listed.objects[pair.other] == nullptr ? kWithOde : kTwoMeshes, 4);
    writer.integer(pair.other, 4);
    writer.integer(pair.mesh, 4);
    writer.integer(pair.remembered.holderIsA ? 1 : 0, 4);
    writer.vector(pair.remembered.origin);
    writer.state(pair.remembered.history.before);
    writer.state(pair.remembered.history.current);
  }
  writer.integer(fnv1a(writer.bytes().data(), writer.bytes().size()), 8);
  return std::move(writer.bytes());
}

}  // namespace
}  // namespace otg

dsizeint dGpuTriMeshHistorySave(const dGeomID* geoms, int count, void* buffer, dsizeint capacity) {
  dsizeint needed = 0;
  otg::guarded([&] {
    otg::Listed listed;
    if ((buffer == nullptr && capacity > 0) || !otg::readList(geoms, count, listed)) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    const std::vector<unsigned char> bytes = otg::serialize(listed);
    if (buffer != nullptr && bytes.size() <= capacity) std::memcpy(buffer, bytes.data(), bytes.size());
    needed = bytes.size();
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  return needed;
}

int dGpuTriMeshHistoryLoad(const dGeomID* geoms, int count, const void* buffer, dsizeint size) {
  return otg::guarded([&] {
    otg::Listed listed;
    std::vector<otg::SavedPair> pairs;
    if (!otg::readList(geoms, count, listed) ||
        !otg::parse(static_cast<const unsigned char*>(buffer), size, listed, pairs)) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    // Everything that may throw comes before the first change.
    std::vector<otg::PairMemory> prepared(listed.objects.size());
    for (const otg::SavedPair& pair : pairs) {
      prepared[pair.mesh].store(pair.remembered.key, pair.remembered.history, pair.remembered.origin,
                                pair.remembered.holderIsA);
    }
    for (std::size_t i = 0; i < prepared.size(); ++i) {
      if (listed.objects[i] != nullptr) listed.objects[i]->memory.swap(prepared[i]);
    }
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshForgetHistory(dGeomID g) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    object->memory.clear();
    if (otg::KeptPairs* const kept = object->keptPairs.get(); kept != nullptr) kept->clear();
    if (otg::KeptShapes* const kept = object->keptShapes.get(); kept != nullptr) kept->clear();
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}
