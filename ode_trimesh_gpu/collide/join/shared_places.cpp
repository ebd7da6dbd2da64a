// SPDX-License-Identifier: BSD-3-Clause
#include "collide/join/shared_places.h"

#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "base/hash.h"
#include "base/vectors.h"

namespace otg {
namespace {

/// Of the largest coordinate: vertices and, with an ODE of single precision, poses are rounded to float, and a rotation
/// adds up three of them.
constexpr double kRounding = 8.0 * std::numeric_limits<float>::epsilon();

/// Places by cells that are larger than what is looked for.
class PlaceGrid {
 public:
  explicit PlaceGrid(double reach) : reach_(reach) {}

  /// The number of the place that lies within reach, or that of a new one.
  std::uint32_t number(const Vec3d& at, std::vector<Vec3d>& places) {
    if (reach_ > 0) {
      const Cell low = cellOf({at.x - reach_, at.y - reach_, at.z - reach_});
      const Cell high = cellOf({at.x + reach_, at.y + reach_, at.z + reach_});
      for (std::int64_t x = low[0]; x <= high[0]; ++x) {
        for (std::int64_t y = low[1]; y <= high[1]; ++y) {
          for (std::int64_t z = low[2]; z <= high[2]; ++z) {
            const auto [first, last] = cells_.equal_range(keyOf({x, y, z}));
            for (auto it = first; it != last; ++it) {
              if (norm(places[it->second] - at) <= reach_) return it->second;
            }
          }
        }
      }
      cells_.emplace(keyOf(cellOf(at)), static_cast<std::uint32_t>(places.size()));
    }
    places.push_back(at);
    return static_cast<std::uint32_t>(places.size() - 1);
  }

  double reach() const { return reach_; }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cellOf(const Vec3d& p) const {
    const double size = 4 * reach_;
    return {static_cast<std::int64_t>(std::floor(p.x / size)), static_cast<std::int64_t>(std::floor(p.y / size)),
            static_cast<std::int64_t>(std::floor(p.z / size))};
  }
  static std::uint64_t keyOf(const Cell& cell) {
    std::uint64_t key = 0;
    for (const std::int64_t c : cell) key = spreadBits(key ^ spreadBits(static_cast<std::uint64_t>(c)));
    return key;
  }

  const double reach_;
  std::unordered_multimap<std::uint64_t, std::uint32_t> cells_;
};

double largestCoordinate(std::span<const JoinPart> parts) {
  double most = 0;
  const auto take = [&](const Vec3d& p) { most = std::max({most, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}); };
  for (const JoinPart& part : parts) {
    const TriMesh& mesh = part.mesh->mesh();
    for (const Vec3f& v : {mesh.boundsMin(), mesh.boundsMax()}) {
      take({v.x, v.y, v.z});
      take(otgTransform(part.pose, Vec3d{v.x, v.y, v.z}));
    }
  }
  return most;
}

}  // namespace

SharedPlaces sharedPlaces(std::span<const JoinPart> parts) {
  SharedPlaces shared;
  PlaceGrid grid(kRounding * largestCoordinate(parts));
  for (const JoinPart& part : parts) {
    const TriMesh& mesh = part.mesh->mesh();
    const SharedArray<std::uint32_t>& weld = mesh.topology().weld;
    std::vector<std::uint32_t>& numbers = shared.numbers.emplace_back(mesh.vertices().size(), kNone);
    const std::size_t before = shared.places.size();
    std::vector<bool> isTaken(before, false);
    for (const Triangle& triangle : mesh.triangles()) {
      for (const std::uint32_t v : triangle.v) {
        std::uint32_t& number = numbers[weld[v]];
        if (number == kNone) {
          const Vec3f& p = mesh.vertices()[weld[v]];
          const Vec3d at = otgTransform(part.pose, Vec3d{p.x, p.y, p.z});
          const std::size_t known = shared.places.size();
          number = grid.number(at, shared.places);
          if (number == known) continue;
          // Two vertices of one mesh stay two, however near they are.
          if (number >= before || isTaken[number]) {
            number = static_cast<std::uint32_t>(known);
            shared.places.push_back(at);
          } else {
            isTaken[number] = true;
          }
        }
      }
      for (const std::uint32_t v : triangle.v) numbers[v] = numbers[weld[v]];
    }
  }
  shared.reach = grid.reach();
  return shared;
}

}  // namespace otg
