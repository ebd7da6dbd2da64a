// SPDX-License-Identifier: BSD-3-Clause
#include "truth/separation_search.h"

#include <cmath>

namespace otg::truth {
namespace {

double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}

std::vector<Vec3d> directionsFor(PairOracle& oracle, const std::vector<Vec3d>& starts) {
  constexpr int kAround = 60;
  constexpr double kGoldenAngle = 2.399963229728653;
  std::vector<Vec3d> all;
  for (const Vec3d& s : starts) {
    if (norm(s) > 0) all.push_back(otgScale(s, 1 / norm(s)));
  }
  for (const Vec3d& n : oracle.faceDirections()) all.push_back(n);
  for (int i = 0; i < kAround; ++i) {
    const double z = 1 - (2.0 * i + 1) / kAround, across = std::sqrt(1 - z * z);
    all.push_back({across * std::cos(kGoldenAngle * i), across * std::sin(kGoldenAngle * i), z});
  }
  return all;
}

class Search {
 public:
  explicit Search(PairOracle& oracle) : oracle_(oracle) {}

  bool apart(const Vec3d& direction, double length) { return !oracle_.overlapped(otgScale(direction, length)); }

  /// Takes the direction if `share` of the best length is enough along it.
  bool improve(const Vec3d& direction, double share) {
    if (!apart(direction, share * length_)) return false;
    double inside = 0, outside = share * length_;
    while (outside - inside > 2e-4 * outside) {
      const double middle = 0.5 * (inside + outside);
      (apart(direction, middle) ? outside : inside) = middle;
      if (outside < 1e-6 * length_) break;  // touching only
    }
    length_ = outside;
    best_ = direction;
    return true;
  }

  bool begin(const std::vector<Vec3d>& directions, double guess, double most) {
    // NOLINTNEXTLINE(clang-analyzer-security.FloatLoopCounter): grows by a factor, the count of rounds is free
    for (double length = guess; length < 1.5 * most; length *= 1.5) {
      for (const Vec3d& d : directions) {
        if (!apart(d, length)) continue;
        length_ = length;
        best_ = d;
        improve(d, 1);
        return true;
      }
    }
    return false;
  }

  /// Directions beside the best one, ever nearer.
  void refine() {
    double turned = 0;
    for (double step = 0.6; step > 4e-3;) {
      const Vec3d helper = std::fabs(best_.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
      Vec3d u = otgCross(best_, helper);
      u = otgScale(u, 1 / norm(u));
      const Vec3d v = otgCross(best_, u);
      bool better = false;
      for (int k = 0; k < 8 && !better; ++k) {
        const double angle = turned + k * M_PI / 4;
        const Vec3d side = otgAdd(otgScale(u, std::cos(angle)), otgScale(v, std::sin(angle)));
        const Vec3d d = otgAdd(best_, otgScale(side, step));
        better = improve(otgScale(d, 1 / norm(d)), 0.998);
      }
      turned += 0.7;
      if (!better) step *= 0.6;
    }
  }

  Vec3d result() const { return otgScale(best_, length_); }
  double length() const { return length_; }

 private:
  PairOracle& oracle_;
  Vec3d best_{0, 0, 0};
  double length_ = 0;
};

}  // namespace

std::optional<Vec3d> shortestSeparation(PairOracle& oracle, double guess, double most,
                                        const std::vector<Vec3d>& starts) {
  if (!oracle.overlapped({0, 0, 0})) return Vec3d{0, 0, 0};
  const std::vector<Vec3d> directions = directionsFor(oracle, starts);
  Search search(oracle);
  if (!search.begin(directions, guess, most)) return {};
  for (int round = 0; round < 3; ++round) {
    const double before = search.length();
    for (const Vec3d& d : directions) search.improve(d, 0.98);
    // A way that first passes through other parts may be free nearer by.
    for (const double share : {0.6, 0.35, 0.2, 0.1}) {
      for (const Vec3d& d : directions) search.improve(d, share);
    }
    search.refine();
    if (search.length() > 0.98 * before) break;
  }
  return search.result();
}

Vec3d shorterSeparation(PairOracle& oracle, const Vec3d& known, const Vec3d& direction) {
  const double length = norm(known);
  if (!(norm(direction) > 0) || !(length > 0)) return known;
  if (oracle.overlapped(otgScale(direction, 0.99 * length / norm(direction)))) return known;
  const std::optional<Vec3d> again = shortestSeparation(oracle, 0.1 * length, 2 * length, {direction, known});
  return again && norm(*again) < length ? *again : known;
}

}  // namespace otg::truth
