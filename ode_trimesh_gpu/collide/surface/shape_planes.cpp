// SPDX-License-Identifier: BSD-3-Clause
#include "collide/surface/shape_planes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace otg {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kGrazes = 1e-8;  ///< of two depths: rounding, where a line grazes the shape

constexpr double kPlaneRounding = 1e-12;  ///< of the shape's size
constexpr std::size_t kFewPlanes = 12;    ///< all of which may as well be tried

template <std::size_t kCount>
const std::array<Vec3d, kCount>& sidesOfPrism() {
  static const std::array<Vec3d, kCount> sides = [] {
    std::array<Vec3d, kCount> out;
    for (std::size_t k = 0; k < kCount; ++k) {
      const double angle = 2 * M_PI * static_cast<double>(k) / kCount;
      out[k] = {std::cos(angle), std::sin(angle), 0};
    }
    return out;
  }();
  return sides;
}

/// A linear function of t along a segment.
struct Line {
  double at, slope;
  double value(double t) const { return at + slope * t; }
};

/// Along a segment: how far below are the planes that face down, and how far below those that face up.
class Depths {
 public:
  void add(double height, double change, double speed) {
    if (speed > 0) {
      bottom_[bottoms_++] = {height / speed, change / speed};
    } else if (speed < 0) {
      top_[tops_++] = {height / speed, change / speed};
    } else if (change < 0) {
      high_ = std::min(high_, height / -change);
    } else if (change > 0) {
      low_ = std::max(low_, height / -change);
    }
  }

  void clear() {
    bottoms_ = tops_ = 0;
    low_ = 0;
    high_ = 1;
  }

  /// The least of the planes that face down: a concave function. It is largest at t, of all places where it is no less
  /// than those that face up; `known` is such a place.
  double deepest(double known) const {
    if (bottoms_ == 0) return known;
    double t = highestOfBottom();
    // From where the bottom is above the top: to where the lines that say so meet, as what is beyond is so, too.
    for (std::size_t i = 0; i < bottoms_ + tops_; ++i) {
      const Line low = bottom(t), high = top(t);
      const double gap = low.value(t) - high.value(t);
      if (gap >= -kGrazes * std::fabs(high.value(t))) return t;
      const double next = t - gap / (low.slope - high.slope);
      const bool isNearer = t < known ? next > t && next < known : next < t && next > known;
      if (!isNearer) return known;
      t = next;
    }
    return t;
  }

 private:
  Line bottom(double t) const {
    return *std::min_element(bottom_.data(), bottom_.data() + bottoms_,
                             [&](const Line& x, const Line& y) { return x.value(t) < y.value(t); });
  }
  Line top(double t) const {
    Line highest{0, 0};  // places below the shape are none
    for (std::size_t i = 0; i < tops_; ++i) {
      if (top_[i].value(t) > highest.value(t)) highest = top_[i];
    }
    return highest;
  }
  /// Between a line that rises and one that falls.
  double highestOfBottom() const {
    Line rising = bottom(low_), falling = bottom(high_);
    if (!(rising.slope > 0)) return low_;
    if (!(falling.slope < 0)) return high_;
    double t = low_;
    for (std::size_t i = 0; i < bottoms_; ++i) {
      t = (falling.at - rising.at) / (rising.slope - falling.slope);
      const Line line = bottom(t);
      if (line.slope == rising.slope || line.slope == falling.slope || !(line.value(t) < rising.value(t))) break;
      (line.slope > 0 ? rising : falling) = line;
    }
    return t;
  }

  std::array<Line, ShapePlanes::kMostPlanes> bottom_, top_;
  std::size_t bottoms_ = 0, tops_ = 0;
  double low_ = 0, high_ = 1;
};

}  // namespace

ShapePlanes::ShapePlanes(const ConvexGeometry& shape)
    : shape_(shape),
      normals_(shape.faceNormals),
      offsets_(shape.faceOffsets),
      slack_(kPlaneRounding * (norm(shape.high - shape.low) + norm(shape.middle))) {
  if (shape.kind != ConvexGeometry::Kind::kCylinder) return;
  std::ranges::copy(normals_, prismNormals_.begin());
  std::ranges::copy(offsets_, prismOffsets_.begin());
  std::ranges::copy(sidesOfPrism<kSides>(), prismNormals_.begin() + 2);
  std::fill(prismOffsets_.begin() + 2, prismOffsets_.end(), shape.radius);
  normals_ = prismNormals_;
  offsets_ = prismOffsets_;
}

double ShapePlanes::roomAround(const Vec3d& inside) const {
  double least = kFar;
  for (std::size_t f = 0; f < normals_.size(); ++f) least = std::min(least, offsets_[f] - otgDot(normals_[f], inside));
  return least;
}

void ShapePlanes::setBox(const Vec3d& low, const Vec3d& high) {
  low_ = low - Vec3d{slack_, slack_, slack_};
  high_ = high + Vec3d{slack_, slack_, slack_};
}

bool ShapePlanes::isInBox(const Vec3d& p) const {
  return p.x >= low_.x && p.y >= low_.y && p.z >= low_.z && p.x <= high_.x && p.y <= high_.y && p.z <= high_.z;
}

bool ShapePlanes::cutsBox(std::size_t f) const {
  const Vec3d& n = normals_[f];
  const Vec3d farthest{n.x > 0 ? high_.x : low_.x, n.y > 0 ? high_.y : low_.y, n.z > 0 ? high_.z : low_.z};
  return otgDot(n, farthest) >= offsets_[f] - slack_;
}

void ShapePlanes::gather(const Vec3d& out, bool isAll, Planes& planes) const {
  planes.count = planes.bottoms = planes.tops = 0;
  const std::size_t faces = shape_.faceNormals.size();
  std::array<std::uint16_t, kMostPlanes> rest;
  std::size_t tops = 0, others = faces;  // from either end
  const auto add = [&](std::size_t f) {
    planes.normals[planes.count] = normals_[f];
    planes.offsets[planes.count] = offsets_[f];
    planes.speeds[planes.count++] = -otgDot(normals_[f], out);
  };
  for (std::size_t f = 0; f < faces; ++f) {
    if (!isAll && !cutsBox(f)) continue;
    const double speed = -otgDot(normals_[f], out);
    if (speed > 0) {
      add(f);
    } else if (speed < 0) {
      rest[tops++] = static_cast<std::uint16_t>(f);
    } else {
      rest[--others] = static_cast<std::uint16_t>(f);
    }
  }
  planes.bottoms = planes.count;
  for (std::size_t i = 0; i < tops; ++i) add(rest[i]);
  planes.tops = tops;
  for (std::size_t i = others; i < faces; ++i) add(rest[i]);
}

void ShapePlanes::lookAt(const Vec3d& low, const Vec3d& high) {
  setBox(low, high);
  gather({0, 0, 0}, shape_.faceNormals.size() <= kFewPlanes, near_);
}

void ShapePlanes::lookAlong(const Vec3d& out, const Vec3d& low, const Vec3d& high) {
  setBox(low, high);
  out_ = out;
  gather(out, shape_.faceNormals.size() <= kFewPlanes, near_);
}

bool ShapePlanes::isWithinSides(const Corners& corners) const {
  const double square = shape_.radius * shape_.radius;
  return shape_.kind == ConvexGeometry::Kind::kCylinder &&
         std::ranges::all_of(corners, [&](const Vec3d& p) { return p.x * p.x + p.y * p.y <= square; });
}

Vec3d ShapePlanes::areaInside(const Corners& corners) {
  const auto height = [&](std::size_t f, const Vec3d& p) { return otgDot(normals_[f], p) - offsets_[f]; };
  const auto isInFront = [&](std::size_t f) {
    return height(f, corners[0]) > 0 && height(f, corners[1]) > 0 && height(f, corners[2]) > 0;
  };
  if (isInFront(facing_)) return {0, 0, 0};
  const double spread = std::max(norm(corners[1] - corners[0]), norm(corners[2] - corners[0]));
  cutCount_ = 0;
  const std::size_t faces = isWithinSides(corners) ? shape_.faceNormals.size() : normals_.size();
  for (std::size_t f = 0; f < faces; ++f) {
    const double first = height(f, corners[0]);
    if (first + spread < 0) continue;
    if (first > 0 && isInFront(f)) {
      facing_ = f;  // as it does most of the next ones
      return {0, 0, 0};
    }
    if (first > 0 || height(f, corners[1]) > 0 || height(f, corners[2]) > 0) {
      cuts_[cutCount_++] = static_cast<std::uint16_t>(f);
    }
  }
  std::size_t count = 3;
  std::copy(corners.begin(), corners.end(), polygon_.begin());
  for (std::size_t c = 0; c < cutCount_; ++c) {
    std::size_t kept = 0;
    Vec3d last = polygon_[count - 1];
    double before = height(cuts_[c], last);
    for (std::size_t i = 0; i < count; ++i) {
      const double here = height(cuts_[c], polygon_[i]);
      if ((before < 0 && here > 0) || (before > 0 && here < 0)) {
        next_[kept++] = last + (polygon_[i] - last) * (before / (before - here));
      }
      if (here <= 0) next_[kept++] = polygon_[i];
      last = polygon_[i];
      before = here;
    }
    if (kept < 3) return {0, 0, 0};
    std::copy(next_.begin(), next_.begin() + static_cast<std::ptrdiff_t>(kept), polygon_.begin());
    count = kept;
  }
  polygonCount_ = count;
  Vec3d sum{0, 0, 0};
  for (std::size_t i = 1; i + 1 < count; ++i) {
    sum = sum + otgCross(polygon_[i] - polygon_[0], polygon_[i + 1] - polygon_[0]);
  }
  return sum;
}

std::uint32_t ShapePlanes::faceOfPart() const {
  std::uint32_t face = kWithin;
  for (const std::uint16_t f : std::span(cuts_.data(), cutCount_)) {
    const auto isOn = [&](const Vec3d& p) { return otgDot(normals_[f], p) >= offsets_[f] - slack_; };
    if (!std::ranges::any_of(polygon(), isOn)) continue;
    if (face != kWithin || f >= shape_.faceNormals.size()) return kSeveral;
    face = f;
  }
  return face;
}

void ShapePlanes::cutBy(const Vec3d& normal, double offset, Stretch& s) {
  const double height = offset - otgDot(normal, s.from), speed = otgDot(normal, s.along);
  if (speed > 0) {
    if (height < s.high * speed) s.high = height / speed;
  } else if (speed < 0) {
    if (height < s.low * speed) s.low = height / speed;
  } else if (height < 0) {
    s.high = s.low;
  }
}

bool ShapePlanes::cut(Stretch& s) const {
  for (std::size_t f = 0; f < near_.count && s.low < s.high; ++f) cutBy(near_.normals[f], near_.offsets[f], s);
  if (!hasAll() && s.low < s.high && !isInBox(s.at(0.5 * (s.low + s.high)))) {
    for (std::size_t f = 0; f < normals_.size() && s.low < s.high; ++f) cutBy(normals_[f], offsets_[f], s);
  }
  if (shape_.kind == ConvexGeometry::Kind::kCylinder) {
    const double a = s.along.x * s.along.x + s.along.y * s.along.y, b = s.along.x * s.from.x + s.along.y * s.from.y;
    const double c = s.from.x * s.from.x + s.from.y * s.from.y - shape_.radius * shape_.radius;
    const double room = b * b - a * c;
    if (a > 0) {
      if (!(room > 0)) return false;
      const double root = std::sqrt(room);
      s.low = std::max(s.low, (-b - root) / a);
      s.high = std::min(s.high, (-b + root) / a);
    } else if (c > 0) {
      return false;
    }
  }
  return s.low < s.high;
}

ShapePlanes::Depth ShapePlanes::depthAlong(const Vec3d& at, const Vec3d& along) const {
  const Depth near = depthBy(near_, at, along);
  if (hasAll() || near.value < 0 || isInBox(at)) return near;
  Planes all;
  gather(out_, true, all);
  return depthBy(all, at, along);
}

ShapePlanes::Depth ShapePlanes::depthBy(const Planes& planes, const Vec3d& at, const Vec3d& along) const {
  Depth least{kFar, 0};
  double most = 0;
  const auto height = [&](std::size_t f) { return planes.offsets[f] - otgDot(planes.normals[f], at); };
  std::size_t f = 0;
  for (; f < planes.bottoms; ++f) {
    const double here = height(f), speed = planes.speeds[f];
    if (here < least.value * speed) least = {here / speed, -otgDot(planes.normals[f], along) / speed};
  }
  for (; f < planes.bottoms + planes.tops; ++f) {
    const double here = height(f), speed = planes.speeds[f];
    if (here < most * speed) most = here / speed;
  }
  for (; f < planes.count; ++f) {
    if (height(f) < 0) return {-1, 0};
  }
  if (shape_.kind == ConvexGeometry::Kind::kCylinder) {
    const double a = out_.x * out_.x + out_.y * out_.y, b = out_.x * at.x + out_.y * at.y;
    const double c = at.x * at.x + at.y * at.y - shape_.radius * shape_.radius, room = b * b - a * c;
    if (!(a > 0 ? room >= 0 : c <= 0)) return {-1, 0};
    if (a > 0) {
      const double root = std::sqrt(room);
      most = std::max(most, (b - root) / a);
      if (b + root < least.value * a) {
        const double change = out_.x * along.x + out_.y * along.y, around = at.x * along.x + at.y * along.y;
        least = {(b + root) / a, (change + (b * change - a * around) / root) / a};
      }
    }
  }
  return least.value >= (1 - kGrazes) * most ? least : Depth{-1, 0};
}

double ShapePlanes::deepest(const Stretch& s, double enough) const {
  if (shape_.kind == ConvexGeometry::Kind::kCylinder) return deepestOfRound(s, enough);
  const double known = 0.5 * (s.low + s.high);
  Depths depths;
  const auto add = [&](const Vec3d& normal, double offset, double speed) {
    depths.add(offset - otgDot(normal, s.from), -otgDot(normal, s.along), speed);
  };
  for (std::size_t f = 0; f < near_.count; ++f) add(near_.normals[f], near_.offsets[f], near_.speeds[f]);
  const double t = depths.deepest(known);
  if (hasAll() || isInBox(s.at(t))) return t;
  // Beyond the box others may have a say.
  depths.clear();
  for (std::size_t f = 0; f < normals_.size(); ++f) add(normals_[f], offsets_[f], -otgDot(normals_[f], out_));
  return depths.deepest(known);
}

double ShapePlanes::deepestOfRound(const Stretch& s, double enough) const {
  constexpr int kMostSteps = 60;
  constexpr double kAsDeep = 1 + 1e-12;
  const double middle = 0.5 * (s.low + s.high);
  // A concave function, where it is one: where it neither rises nor falls. It is below its tangents, and where two of
  // them meet is tried next (J. Kelley 1960).
  struct End {
    double t;
    bool isTried;
    std::optional<Line> tangent;
  };
  End low{0, false, {}}, high{1, false, {}};
  double t = middle, best = middle, most = 0;
  for (int i = 0; i < kMostSteps; ++i) {
    const Depth here = depthAlong(s.at(t), s.along);
    const bool isIn = here.value >= 0;
    if (here.value > most) {
      most = here.value;
      best = t;
    }
    End& end = (isIn ? here.slope > 0 : t < middle) ? low : high;
    end = {t, true, {}};
    if (isIn) end.tangent = Line{here.value - here.slope * t, here.slope};
    double bound = kFar, next = 0.5 * (low.t + high.t);
    if (low.tangent && high.tangent) {
      next = (high.tangent->at - low.tangent->at) / (low.tangent->slope - high.tangent->slope);
      bound = low.tangent->value(next);
    } else if (low.tangent) {
      bound = low.tangent->value(high.t);
      if (!high.isTried) next = high.t;
    } else if (high.tangent) {
      bound = high.tangent->value(low.t);
      if (!low.isTried) next = low.t;
    }
    if (!(bound > std::max(enough, kAsDeep * most)) || !(next >= low.t && next <= high.t) || next == t) break;
    t = next;
  }
  return best;
}

}  // namespace otg
