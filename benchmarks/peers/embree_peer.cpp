// SPDX-License-Identifier: BSD-3-Clause
// Embree: rtcCollide over two scenes of triangle boxes, then a triangle test in double. B's vertices are moved to A's
// frame and its tree is built there beforehand. So this is a lower bound for the tree traversal, and not a whole query.
#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "peers/peer.h"

namespace otg::peers {
namespace {

struct Soup {
  std::vector<Vec3d> vertices;
  std::span<const Triangle> triangles;
};

void bounds(const RTCBoundsFunctionArguments* arguments) {
  const Soup& soup = *static_cast<const Soup*>(arguments->geometryUserPtr);
  const Triangle& t = soup.triangles[arguments->primID];
  const Vec3d &a = soup.vertices[t.v[0]], &b = soup.vertices[t.v[1]], &c = soup.vertices[t.v[2]];
  // Rounded outward, so that the boxes hold the vertices in double.
  const auto low = [](double x, double y, double z) { return std::nextafter(float(std::min({x, y, z})), -INFINITY); };
  const auto high = [](double x, double y, double z) { return std::nextafter(float(std::max({x, y, z})), INFINITY); };
  RTCBounds& box = *arguments->bounds_o;
  box.lower_x = low(a.x, b.x, c.x);
  box.lower_y = low(a.y, b.y, c.y);
  box.lower_z = low(a.z, b.z, c.z);
  box.upper_x = high(a.x, b.x, c.x);
  box.upper_y = high(a.y, b.y, c.y);
  box.upper_z = high(a.z, b.z, c.z);
}

double orient(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  return otgDot(otgCross(otgSub(b, a), otgSub(c, a)), otgSub(d, a));
}

/// The segment pq goes through the triangle; touching counts, lying in its plane does not.
bool crosses(const Vec3d& p, const Vec3d& q, const Vec3d* t) {
  const double sp = orient(t[0], t[1], t[2], p), sq = orient(t[0], t[1], t[2], q);
  if ((sp > 0 && sq > 0) || (sp < 0 && sq < 0) || (sp == 0 && sq == 0)) return false;
  const double u = orient(p, q, t[0], t[1]), v = orient(p, q, t[1], t[2]), w = orient(p, q, t[2], t[0]);
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

bool intersect(const Vec3d* a, const Vec3d* b) {
  const double s0 = orient(b[0], b[1], b[2], a[0]), s1 = orient(b[0], b[1], b[2], a[1]),
               s2 = orient(b[0], b[1], b[2], a[2]);
  if ((s0 > 0 && s1 > 0 && s2 > 0) || (s0 < 0 && s1 < 0 && s2 < 0)) return false;
  for (int i = 0; i < 3; ++i) {
    if (crosses(a[i], a[(i + 1) % 3], b) || crosses(b[i], b[(i + 1) % 3], a)) return true;
  }
  return false;
}

class EmbreePeer final : public Peer {
 public:
  explicit EmbreePeer(const PeerScene& scene) {
    // One thread, as all others.
    device_ = rtcNewDevice("threads=1");
    if (device_ == nullptr) throw std::runtime_error("Embree gives no device");
    soups_[0].triangles = scene.a->triangles();
    soups_[1].triangles = scene.b->triangles();
    for (const Vec3f& v : scene.a->vertices()) soups_[0].vertices.push_back({v.x, v.y, v.z});
    for (const Vec3f& v : scene.b->vertices()) {
      soups_[1].vertices.push_back(otgTransform(scene.bInA, Vec3d{v.x, v.y, v.z}));
    }
    for (int i = 0; i < 2; ++i) {
      scenes_[i] = rtcNewScene(device_);
      const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
      rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(soups_[i].triangles.size()));
      rtcSetGeometryUserData(geometry, &soups_[i]);
      rtcSetGeometryBoundsFunction(geometry, &bounds, nullptr);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scenes_[i], geometry);
      rtcReleaseGeometry(geometry);
      rtcCommitScene(scenes_[i]);
    }
  }
  ~EmbreePeer() override {
    for (const RTCScene scene : scenes_) rtcReleaseScene(scene);
    rtcReleaseDevice(device_);
  }
  EmbreePeer(const EmbreePeer&) = delete;
  EmbreePeer& operator=(const EmbreePeer&) = delete;
  void query() override {
    pairs_.clear();
    rtcCollide(scenes_[0], scenes_[1], &collide, this);
  }
  std::size_t resultCount() const override { return pairs_.size(); }
  std::vector<double> resultNumbers() const override {
    std::vector<std::pair<unsigned, unsigned>> sorted = pairs_;
    std::sort(sorted.begin(), sorted.end());
    std::vector<double> numbers;
    for (const auto& [a, b] : sorted) numbers.insert(numbers.end(), {double(a), double(b)});
    return numbers;
  }

 private:
  static void collide(void* self, RTCCollision* collisions, unsigned count) {
    EmbreePeer& peer = *static_cast<EmbreePeer*>(self);
    for (unsigned i = 0; i < count; ++i) {
      const unsigned ids[2] = {collisions[i].primID0, collisions[i].primID1};
      Vec3d corners[2][3];
      for (int side = 0; side < 2; ++side) {
        const Soup& soup = peer.soups_[side];
        for (int k = 0; k < 3; ++k) corners[side][k] = soup.vertices[soup.triangles[ids[side]].v[k]];
      }
      if (intersect(corners[0], corners[1])) peer.pairs_.emplace_back(ids[0], ids[1]);
    }
  }
  RTCDevice device_ = nullptr;
  RTCScene scenes_[2] = {nullptr, nullptr};
  Soup soups_[2];
  std::vector<std::pair<unsigned, unsigned>> pairs_;
};

}  // namespace

std::unique_ptr<Peer> makeEmbreePeer(const PeerScene& scene) {
  return std::make_unique<EmbreePeer>(scene);
}

}  // namespace otg::peers
