// SPDX-License-Identifier: BSD-3-Clause
#include "collide/surface/placed_body.h"

#include <algorithm>

namespace otg {

PlacedBody::Rear::Rear(const PlacedBody& body, const Vec3d& d)
    : body_(body),
      back_(body.directionToLocal(d) * -1.0),
      slope_(std::fabs(back_.z)),
      across_(std::sqrt(back_.x * back_.x + back_.y * back_.y)) {}

Vec3d PlacedBody::Rear::near(const Vec3d& position) const {
  const ConvexGeometry& body = body_.body();
  Vec3d p = body_.toLocal(position);
  const double radius = body.radius;
  p.z = std::clamp(p.z, -body.length, body.length);
  if (body.kind == ConvexGeometry::Kind::kCapsule) return body_.fromLocal(Vec3d{0, 0, p.z} + back_ * radius);
  if (slope_ < kOnSide) {
    p.x = radius * back_.x / across_;
    p.y = radius * back_.y / across_;
  } else if (const double out = std::sqrt(p.x * p.x + p.y * p.y); out > radius) {
    p.x *= radius / out;
    p.y *= radius / out;
  }
  if (slope_ > kOnEnd) p.z = std::copysign(body.length, back_.z);
  return body_.fromLocal(p);
}

}  // namespace otg
