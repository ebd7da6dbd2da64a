// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/wide_search.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/vectors.h"

namespace otg {
namespace {

// Vectors of the compiler's; none is passed to a function, so that their calling convention doesn't matter.
typedef float Floats __attribute__((vector_size(16)));
typedef std::int32_t Ints __attribute__((vector_size(16)));
constexpr int kLanes = 4;

/// What single precision may be off by, relative to the size of the numbers that went in: some roundings' worth.
constexpr double kSlack = 4e-6;

#define OTG_LOAD(into, from) \
  Floats into;               \
  std::memcpy(&(into), from, sizeof(into))

/// The lanes from k on of the boxes of `node`: cx, cy, cz and ex, ey, ez. In functions with kScaled and scale_, which
/// the boxes are taken through: scaledBox() of as many at once.
#define OTG_LOAD_BOXES                                          \
  OTG_LOAD(cx, node.centerX + k);                               \
  OTG_LOAD(cy, node.centerY + k);                               \
  OTG_LOAD(cz, node.centerZ + k);                               \
  OTG_LOAD(ex, node.extentX + k);                               \
  OTG_LOAD(ey, node.extentY + k);                               \
  OTG_LOAD(ez, node.extentZ + k);                               \
  if constexpr (kScaled) {                                      \
    const BoxScale<float>& s = *scale_;                         \
    cx = s.factor.x * cx + s.shift.x;                           \
    cy = s.factor.y * cy + s.shift.y;                           \
    cz = s.factor.z * cz + s.shift.z;                           \
    ex = s.growth.x * ex + (s.slope * magnitude(cx) + s.pad.x); \
    ey = s.growth.y * ey + (s.slope * magnitude(cy) + s.pad.y); \
    ez = s.growth.z * ez + (s.slope * magnitude(cz) + s.pad.z); \
  }                                                             \
  static_assert(true)

inline Floats magnitude(const Floats& x) {
  constexpr std::int32_t kAllButSign = 0x7fffffff;
  Ints bits;
  std::memcpy(&bits, &x, sizeof bits);
  bits &= kAllButSign;
  Floats size;
  std::memcpy(&size, &bits, sizeof size);
  return size;
}

/// Bits of lanes whose comparison is true.
inline unsigned bitsOf(const Ints& m) {
#if defined(__SSE__)
  Floats signs;
  std::memcpy(&signs, &m, sizeof signs);
  return static_cast<unsigned>(__builtin_ia32_movmskps(signs));
#else
  unsigned bits = 0;
  for (int k = 0; k < kLanes; ++k) bits |= static_cast<unsigned>(m[k] != 0) << k;
  return bits;
#endif
}

Vec3d centred(const TriMesh& mesh, const Vec3d& p) {
  return p - Vec3d{mesh.origin().x, mesh.origin().y, mesh.origin().z};
}

float clampedFloat(double x) {
  constexpr double kLargest = 1e30;
  return static_cast<float>(std::clamp(x, -kLargest, kLargest));
}

unsigned used(const WideNode& node) {
  return (1u << node.count) - 1;
}

}  // namespace

BallQuery::BallQuery(const CollisionMesh& tree, const Vec3d& center, double radius) : scale_(tree.boxScale()) {
  const TriMesh& mesh = tree.mesh();
  const Vec3d c = centred(mesh, center);
  x_ = clampedFloat(c.x);
  y_ = clampedFloat(c.y);
  z_ = clampedFloat(c.z);
  const double reach = radius + kSlack * (norm(c) + double{mesh.radius()} + radius);
  reach2_ = static_cast<float>(std::min(reach, 1e18) * std::min(reach, 1e18));
}

unsigned BallQuery::operator()(const WideNode& node) const {
  return scale_ == nullptr ? test<false>(node) : test<true>(node);
}

template <bool kScaled>
unsigned BallQuery::test(const WideNode& node) const {
  unsigned bits = 0;
  for (int k = 0; k < kWideArity; k += kLanes) {
    OTG_LOAD_BOXES;
    const Floats zero = {};
    Floats dx = cx - x_, dy = cy - y_, dz = cz - z_;
    dx = magnitude(dx) - ex;
    dy = magnitude(dy) - ey;
    dz = magnitude(dz) - ez;
    dx = dx > zero ? dx : zero;
    dy = dy > zero ? dy : zero;
    dz = dz > zero ? dz : zero;
    bits |= bitsOf(dx * dx + dy * dy + dz * dz <= zero + reach2_) << k;
  }
  return bits & used(node);
}

BelowQuery::BelowQuery(const CollisionMesh& tree, const Vec3d& normal, double offset) : scale_(tree.boxScale()) {
  const TriMesh& mesh = tree.mesh();
  const double n[3] = {normal.x, normal.y, normal.z};
  for (int i = 0; i < 3; ++i) {
    n_[i] = static_cast<float>(n[i]);
    size_[i] = static_cast<float>(std::fabs(n[i]));
  }
  const Vec3f& c = mesh.origin();
  const double shifted = offset - otgDot(normal, Vec3d{c.x, c.y, c.z});
  offset_ = clampedFloat(shifted + kSlack * (std::fabs(shifted) + double{mesh.radius()}) + 1e-14 * std::fabs(offset));
}

unsigned BelowQuery::operator()(const WideNode& node) const {
  return scale_ == nullptr ? test<false>(node) : test<true>(node);
}

template <bool kScaled>
unsigned BelowQuery::test(const WideNode& node) const {
  unsigned bits = 0;
  for (int k = 0; k < kWideArity; k += kLanes) {
    OTG_LOAD_BOXES;
    const Floats lowest = (n_[0] * cx + n_[1] * cy + n_[2] * cz) - (size_[0] * ex + size_[1] * ey + size_[2] * ez);
    bits |= bitsOf(lowest <= Floats{} + offset_) << k;
  }
  return bits & used(node);
}

BoxQuery::BoxQuery(const CollisionMesh& tree, const Transformd& toMesh, const Vec3d& half) : scale_(tree.boxScale()) {
  const TriMesh& mesh = tree.mesh();
  const Vec3d c = centred(mesh, toMesh.t);
  const double slack = kSlack * (norm(c) + double{mesh.radius()} + norm(half));
  const double middle[3] = {c.x, c.y, c.z}, h[3] = {half.x, half.y, half.z};
  for (int i = 0; i < 3; ++i) {
    double along = 0;
    for (int j = 0; j < 3; ++j) {
      r_[3 * i + j] = static_cast<float>(toMesh.r[3 * i + j]);
      size_[3 * i + j] = std::fabs(r_[3 * i + j]);
      along += std::fabs(toMesh.r[3 * i + j]) * h[j];
    }
    center_[i] = clampedFloat(middle[i]);
    half_[i] = clampedFloat(h[i] + slack);
    inMesh_[i] = clampedFloat(along + slack);
  }
}

unsigned BoxQuery::operator()(const WideNode& node) const {
  return scale_ == nullptr ? test<false>(node) : test<true>(node);
}

template <bool kScaled>
unsigned BoxQuery::test(const WideNode& node) const {
  unsigned bits = 0;
  for (int k = 0; k < kWideArity; k += kLanes) {
    OTG_LOAD_BOXES;
    const Floats dx = cx - center_[0], dy = cy - center_[1], dz = cz - center_[2];
    Ints near =
        (magnitude(dx) <= ex + inMesh_[0]) & (magnitude(dy) <= ey + inMesh_[1]) & (magnitude(dz) <= ez + inMesh_[2]);
    if (bitsOf(near) == 0) continue;
    for (int j = 0; j < 3; ++j) {
      const Floats along = r_[j] * dx + r_[3 + j] * dy + r_[6 + j] * dz;
      const Floats reach = size_[j] * ex + size_[3 + j] * ey + size_[6 + j] * ez + half_[j];
      near &= magnitude(along) <= reach;
    }
    bits |= bitsOf(near) << k;
  }
  return bits & used(node);
}

RayQuery::RayQuery(const CollisionMesh& tree, const Vec3d& origin, const Vec3d& direction) : scale_(tree.boxScale()) {
  const TriMesh& mesh = tree.mesh();
  const Vec3d from = centred(mesh, origin);
  const double o[3] = {from.x, from.y, from.z}, d[3] = {direction.x, direction.y, direction.z};
  const Vec3f &low = mesh.boundsMin(), &high = mesh.boundsMax(), &c = mesh.origin();
  const double lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z}, middle[3] = {c.x, c.y, c.z};
  // Boxes are wider than their triangles by rounding; and by more where the ray comes from far away.
  const double wider = kSlack * double{mesh.radius()} + 1e-13 * (norm(from) + norm(origin));
  double near = 0, far = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double a = lows[k] - middle[k] - wider - o[k], b = highs[k] - middle[k] + wider - o[k];
    if (d[k] == 0) {
      if (a > 0 || b < 0) return;
      continue;
    }
    near = std::max(near, std::min(a / d[k], b / d[k]));
    far = std::min(far, std::max(a / d[k], b / d[k]));
  }
  if (!(near <= far * (1 + 1e-12))) return;
  meets_ = true;
  start_ = near;
  wider_ = static_cast<float>(2 * wider);
  double fastest = 0;
  for (int k = 0; k < 3; ++k) {
    o_[k] = clampedFloat(o[k] + near * d[k]);
    // Slower than this it does not leave a box's range within the mesh.
    constexpr double kStill = 1e-18;
    inverse_[k] = std::fabs(d[k]) > kStill ? clampedFloat(1 / d[k]) : static_cast<float>(1 / kStill);
    sign_[k] = std::copysign(1.0f, inverse_[k]);
    fastest = std::max(fastest, std::fabs(d[k]));
  }
  // t where the bounds begin is known to within rounding of far origins; times are compared with that much room.
  slack_ = fastest > 0 ? 2 * wider / fastest : 0;
}

unsigned RayQuery::children(const WideNode& node, double limit, float near[kWideArity]) const {
  return scale_ == nullptr ? test<false>(node, limit, near) : test<true>(node, limit, near);
}

template <bool kScaled>
unsigned RayQuery::test(const WideNode& node, double limit, float near[kWideArity]) const {
  // Roundings of a slab's times, all relative.
  constexpr float kLater = 1 + 2e-6f, kEarlier = 1 - 2e-6f;
  const float last = clampedFloat(std::max(0.0, (limit - start_) + slack_)) * kLater;
  unsigned bits = 0;
  for (int k = 0; k < kWideArity; k += kLanes) {
    OTG_LOAD_BOXES;
    const Floats zero = {};
    const Floats dx = cx - o_[0], dy = cy - o_[1], dz = cz - o_[2];
    // A ray that comes from above enters there.
    const Floats wx = (ex + wider_) * sign_[0], wy = (ey + wider_) * sign_[1], wz = (ez + wider_) * sign_[2];
    const Floats nx = (dx - wx) * inverse_[0], fx = (dx + wx) * inverse_[0];
    const Floats ny = (dy - wy) * inverse_[1], fy = (dy + wy) * inverse_[1];
    const Floats nz = (dz - wz) * inverse_[2], fz = (dz + wz) * inverse_[2];
    Floats enter = nx > ny ? nx : ny, leave = fx < fy ? fx : fy;
    enter = enter > nz ? enter : nz;
    leave = leave < fz ? leave : fz;
    enter = (enter > zero ? enter : zero) * kEarlier;
    std::memcpy(near + k, &enter, sizeof enter);
    bits |= bitsOf((enter <= leave * kLater) & (enter <= zero + last)) << k;
  }
  return bits & used(node);
}

}  // namespace otg
