// SPDX-License-Identifier: BSD-3-Clause
// Pair histories as bytes: written and read number by number, little end first, so that neither the machine nor the
// compiler shows in them.
//
//   8  "OTGHIST" and a zero byte
//   4  version
//   4  number of geoms, 4 number of pairs
//   for each pair, oldest query first within its younger geom:
//     4  place of the older geom, 4 of the younger one
//     twice (before and current) a state: escape 3 x 8, escapeLeft 4, clampLeft 4, deepNormal 3 x 8, pose 12 x 8, 4
//     hasPose
//   8  FNV-1a of all that
#include "ode_trimesh_gpu/history.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <unordered_map>
#include <vector>

#include "ode/geom_class.h"
#include "ode/status.h"

namespace otg {
namespace {

constexpr char kMagic[8] = "OTGHIST";
constexpr std::uint32_t kVersion = 1;
// Whoever adds to what is remembered must write it, too, and raise the version.
static_assert(sizeof(SolidHistory::State) == 3 * 8 + 2 * 4 + 3 * 8 + 12 * 8 + 8);

std::uint64_t checksum(const unsigned char* bytes, std::size_t count) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i < count; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;
  return hash;
}

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
    return s;
  }

 private:
  const unsigned char* at_;
  std::size_t left_;
  bool good_ = true;
};

/// Objects of the listed geoms, null for those that are not of our class. False for a list that is none.
bool readList(const dGeomID* geoms, int count, std::vector<GeomObject*>& objects,
              std::unordered_map<std::uint64_t, std::uint32_t>& placeOf) {
  if (count < 0 || (count > 0 && geoms == nullptr)) return false;
  for (int i = 0; i < count; ++i) {
    objects.push_back(objectOf(geoms[i]));
    if (objects.back() == nullptr) continue;
    if (!placeOf.try_emplace(objects.back()->serial, static_cast<std::uint32_t>(i)).second) return false;
  }
  return true;
}

struct SavedPair {
  std::uint32_t older, younger;
  SolidHistory history;
};

/// False if the bytes are not what was saved, or do not fit the geoms.
bool parse(const unsigned char* bytes, std::size_t size, const std::vector<GeomObject*>& objects,
           std::vector<SavedPair>& pairs) {
  if (bytes == nullptr || size < sizeof kMagic + 8 || std::memcmp(bytes, kMagic, sizeof kMagic) != 0) return false;
  Reader tail(bytes + size - 8, 8);
  if (tail.integer(8) != checksum(bytes, size - 8)) return false;
  Reader reader(bytes + sizeof kMagic, size - 8 - sizeof kMagic);
  if (reader.integer(4) != kVersion || reader.integer(4) != objects.size()) return false;
  const std::uint64_t count = reader.integer(4);
  for (std::uint64_t i = 0; i < count && reader.good(); ++i) {
    SavedPair pair;
    pair.older = static_cast<std::uint32_t>(reader.integer(4));
    pair.younger = static_cast<std::uint32_t>(reader.integer(4));
    pair.history.before = reader.state();
    pair.history.current = reader.state();
    pair.history.used = true;
    if (pair.older >= objects.size() || pair.younger >= objects.size()) return false;
    const GeomObject *older = objects[pair.older], *younger = objects[pair.younger];
    if (older == nullptr || younger == nullptr || !(older->serial < younger->serial)) return false;
    pairs.push_back(pair);
  }
  return reader.good() && reader.atEnd();
}

std::vector<unsigned char> serialize(const std::vector<GeomObject*>& objects,
                                     const std::unordered_map<std::uint64_t, std::uint32_t>& placeOf) {
  std::vector<SavedPair> pairs;
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    if (objects[i] == nullptr) continue;
    for (const auto& [other, history] : objects[i]->memory.all()) {
      const auto place = placeOf.find(other);
      if (place != placeOf.end()) pairs.push_back({place->second, i, history});
    }
  }
  Writer writer;
  for (const char c : kMagic) writer.integer(static_cast<unsigned char>(c), 1);
  writer.integer(kVersion, 4);
  writer.integer(objects.size(), 4);
  writer.integer(pairs.size(), 4);
  for (const SavedPair& pair : pairs) {
    writer.integer(pair.older, 4);
    writer.integer(pair.younger, 4);
    writer.state(pair.history.before);
    writer.state(pair.history.current);
  }
  writer.integer(checksum(writer.bytes().data(), writer.bytes().size()), 8);
  return std::move(writer.bytes());
}

}  // namespace
}  // namespace otg

dsizeint dGpuTriMeshHistorySave(const dGeomID* geoms, int count, void* buffer, dsizeint capacity) {
  dsizeint needed = 0;
  otg::guarded([&] {
    std::vector<otg::GeomObject*> objects;
    std::unordered_map<std::uint64_t, std::uint32_t> placeOf;
    if ((buffer == nullptr && capacity > 0) || !otg::readList(geoms, count, objects, placeOf)) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    const std::vector<unsigned char> bytes = otg::serialize(objects, placeOf);
    if (bytes.size() <= capacity) std::memcpy(buffer, bytes.data(), bytes.size());
    needed = bytes.size();
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  return needed;
}

int dGpuTriMeshHistoryLoad(const dGeomID* geoms, int count, const void* buffer, dsizeint size) {
  return otg::guarded([&] {
    std::vector<otg::GeomObject*> objects;
    std::unordered_map<std::uint64_t, std::uint32_t> placeOf;
    std::vector<otg::SavedPair> pairs;
    if (!otg::readList(geoms, count, objects, placeOf) ||
        !otg::parse(static_cast<const unsigned char*>(buffer), size, objects, pairs)) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    // Everything that may throw comes before the first change.
    std::vector<otg::PairMemory::Histories> byGeom(objects.size());
    for (const otg::SavedPair& pair : pairs) {
      byGeom[pair.younger].emplace_back(objects[pair.older]->serial, pair.history);
    }
    std::vector<otg::PairMemory> prepared(objects.size());
    for (std::size_t i = 0; i < objects.size(); ++i) {
      for (const auto& [other, history] : byGeom[i]) prepared[i].store(other, history);
    }
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (objects[i] != nullptr) objects[i]->memory.swap(prepared[i]);
    }
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshForgetHistory(dGeomID g) {
  otg::GeomObject* const object = otg::objectOf(g);
  if (object == nullptr) return otg::noteStatus(dGPUTRIMESH_ERROR_CLASS);
  object->memory.clear();
  return dGPUTRIMESH_OK;
}
