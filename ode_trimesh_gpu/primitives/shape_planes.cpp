// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/shape_planes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace otg {
namespace {

constexpr std::size_t kSides = 24;  ///< of the prism around a cylinder
constexpr double kGrazes = 1e-8;    ///< of two depths: rounding, where a line grazes the shape

const std::array<Vec3d, kSides>& sidesOfPrism() {
  static const std::array<Vec3d, kSides> sides = [] {
    std::array<Vec3d, kSides> out;
    for (std::size_t k = 0; k < kSides; ++k) {
      const double angle = 2 * M_PI * static_cast<double>(k) / kSides;
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

  double at(double t) const { return bottoms_ == 0 ? 0 : bottom(t).value(t); }

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

ShapePlanes::ShapePlanes(const ConvexShape& shape) : shape_(shape) {
  const auto add = [&](const Vec3d& normal, double offset) {
    if (count_ < kMostPlanes) {
      normals_[count_] = normal;
      offsets_[count_] = offset;
    }
    ++count_;
  };
  for (std::size_t f = 0; f < shape.faceNormals.size(); ++f) add(shape.faceNormals[f], shape.faceOffsets[f]);
  if (shape.kind != ConvexShape::Kind::kCylinder) return;
  for (const Vec3d& side : sidesOfPrism()) add(side, shape.radius);
}

double ShapePlanes::roomAround(const Vec3d& inside) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t f = 0; f < count_; ++f) least = std::min(least, offsets_[f] - otgDot(normals_[f], inside));
  return least;
}

Vec3d ShapePlanes::areaInside(const Corners& corners) {
  const auto cornersOut = [&](std::size_t f) {
    const auto isOut = [&](const Vec3d& p) { return otgDot(normals_[f], p) > offsets_[f]; };
    return isOut(corners[0]) + isOut(corners[1]) + isOut(corners[2]);
  };
  if (cornersOut(facing_) == 3) return {0, 0, 0};
  std::array<std::uint16_t, kMostPlanes> cuts;
  std::size_t cutCount = 0;
  for (std::size_t f = 0; f < count_; ++f) {
    const int out = cornersOut(f);
    if (out == 3) {
      facing_ = f;  // as it does most of the next ones
      return {0, 0, 0};
    }
    if (out > 0) cuts[cutCount++] = static_cast<std::uint16_t>(f);
  }
  std::size_t count = 3;
  std::copy(corners.begin(), corners.end(), polygon_.begin());
  for (std::size_t c = 0; c < cutCount; ++c) {
    const auto height = [&, f = cuts[c]](const Vec3d& p) { return otgDot(normals_[f], p) - offsets_[f]; };
    std::size_t kept = 0;
    Vec3d last = polygon_[count - 1];
    double before = height(last);
    for (std::size_t i = 0; i < count; ++i) {
      const double here = height(polygon_[i]);
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
  Vec3d sum{0, 0, 0};
  for (std::size_t i = 1; i + 1 < count; ++i) {
    sum = sum + otgCross(polygon_[i] - polygon_[0], polygon_[i + 1] - polygon_[0]);
  }
  return sum;
}

bool ShapePlanes::cut(Stretch& s) const {
  for (std::size_t f = 0; f < shape_.faceNormals.size(); ++f) {
    const double height = offsets_[f] - otgDot(normals_[f], s.from), speed = otgDot(normals_[f], s.along);
    if (speed > 0) {
      s.high = std::min(s.high, height / speed);
    } else if (speed < 0) {
      s.low = std::max(s.low, height / speed);
    } else if (height < 0) {
      return false;
    }
  }
  if (shape_.kind == ConvexShape::Kind::kCylinder) {
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

ShapePlanes::Depth ShapePlanes::depthAlong(const Vec3d& at, const Vec3d& along, const Vec3d& out) const {
  Depth least{std::numeric_limits<double>::infinity(), 0};
  double most = 0;
  for (std::size_t f = 0; f < shape_.faceNormals.size(); ++f) {
    const double height = offsets_[f] - otgDot(normals_[f], at), speed = -otgDot(normals_[f], out);
    if (speed > 0) {
      if (height < least.value * speed) least = {height / speed, -otgDot(normals_[f], along) / speed};
    } else if (speed < 0) {
      most = std::max(most, height / speed);
    } else if (height < 0) {
      return {-1, 0};
    }
  }
  if (shape_.kind == ConvexShape::Kind::kCylinder) {
    const double a = out.x * out.x + out.y * out.y, b = out.x * at.x + out.y * at.y;
    const double c = at.x * at.x + at.y * at.y - shape_.radius * shape_.radius, room = b * b - a * c;
    if (!(a > 0 ? room >= 0 : c <= 0)) return {-1, 0};
    if (a > 0) {
      const double root = std::sqrt(room);
      most = std::max(most, (b - root) / a);
      if (b + root < least.value * a) {
        const double change = out.x * along.x + out.y * along.y, around = at.x * along.x + at.y * along.y;
        least = {(b + root) / a, (change + (b * change - a * around) / root) / a};
      }
    }
  }
  return least.value >= (1 - kGrazes) * most ? least : Depth{-1, 0};
}

double ShapePlanes::deepest(const Stretch& s, const Vec3d& out, double enough) const {
  const double known = 0.5 * (s.low + s.high);
  Depths depths;
  for (std::size_t f = 0; f < count_; ++f) {
    depths.add(offsets_[f] - otgDot(normals_[f], s.from), -otgDot(normals_[f], s.along), -otgDot(normals_[f], out));
  }
  double t = depths.deepest(known);
  if (shape_.kind != ConvexShape::Kind::kCylinder || !(depths.at(t) > enough)) return t;
  // A concave function, too, where it is one: where it neither rises nor falls.
  constexpr int kHalvings = 44;
  double low = 0, high = 1;
  for (int i = 0; i < kHalvings; ++i) {
    t = 0.5 * (low + high);
    const Depth depth = depthAlong(s.at(t), s.along, out);
    if (depth.value < 0 ? t < known : depth.slope > 0) {
      low = t;
    } else {
      high = t;
    }
  }
  return t;
}

}  // namespace otg
