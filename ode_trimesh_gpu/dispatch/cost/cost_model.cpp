// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/cost/cost_model.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/vectors.h"

namespace otg {
namespace {

constexpr char kMagic[8] = {'o', 't', 'g', 'c', 'o', 's', 't', '9'};

/// The part of its box that lies in a part of it.
double shareOfBox(const double part[3], const double whole[3]) {
  double share = 1;
  for (int k = 0; k < 3; ++k) {
    if (part[k] <= 0) return 0;
    if (whole[k] > 0) share *= std::min(1.0, part[k] / whole[k]);
  }
  return share;
}

/// The part of a ball of radius `own` that lies in one of radius `other`, whose middle is so far away.
double shareOfBall(double own, double other, double distance) {
  const double depth = own + other - distance;
  if (!(depth > 0)) return 0;
  if (!(own > 0)) return 1;
  const double apart = own - other;
  if (distance <= std::fabs(apart)) return apart <= 0 ? 1 : std::pow(other / own, 3);
  const double lens = depth * depth * (distance * (distance + 2 * (own + other)) - 3 * apart * apart) / (16 * distance);
  return std::min(1.0, lens / (own * own * own));
}

/// The part of a surface in a part of its box or ball: areas go with the square of lengths.
double surfaceIn(double share) {
  return std::cbrt(share * share);
}

}  // namespace

double expectedWork(const Query& query) {
  const TriMesh &a = query.a->mesh(), &b = query.b->mesh();
  const double lowA[3] = {a.boundsMin().x, a.boundsMin().y, a.boundsMin().z};
  const double highA[3] = {a.boundsMax().x, a.boundsMax().y, a.boundsMax().z};
  const double lowB[3] = {b.boundsMin().x, b.boundsMin().y, b.boundsMin().z};
  const double highB[3] = {b.boundsMax().x, b.boundsMax().y, b.boundsMax().z};
  const Vec3d center = otgTransform(
      query.bInA, Vec3d{0.5 * (lowB[0] + highB[0]), 0.5 * (lowB[1] + highB[1]), 0.5 * (lowB[2] + highB[2])});
  const double c[3] = {center.x, center.y, center.z};
  if (!std::isfinite(c[0] + c[1] + c[2])) return 0;
  double part[3], sizeA[3], sizeB[3];  // all along A's axes
  for (int row = 0; row < 3; ++row) {
    double half = 0;
    for (int k = 0; k < 3; ++k) half += std::abs(query.bInA.r[3 * row + k]) * 0.5 * (highB[k] - lowB[k]);
    part[row] = std::min(highA[row], c[row] + half) - std::max(lowA[row], c[row] - half);
    sizeA[row] = highA[row] - lowA[row];
    sizeB[row] = 2 * half;
  }
  const Vec3f &middleA = a.center(), &middleB = b.center();
  const Vec3d apart =
      otgSub(otgTransform(query.bInA, Vec3d{middleB.x, middleB.y, middleB.z}), Vec3d{middleA.x, middleA.y, middleA.z});
  const double radiusA = a.radius(), radiusB = b.radius(), distance = norm(apart);
  const double shareA = std::min(shareOfBox(part, sizeA), shareOfBall(radiusA, radiusB, distance));
  const double shareB = std::min(shareOfBox(part, sizeB), shareOfBall(radiusB, radiusA, distance));
  const double work = static_cast<double>(a.triangleCount()) * surfaceIn(shareA) +
                      static_cast<double>(b.triangleCount()) * surfaceIn(shareB);
  return std::isfinite(work) ? work : 0;
}

double pointWork(const TriMesh& mesh) {
  return std::log2(1.0 + static_cast<double>(mesh.triangleCount()));
}

bool CostModel::isSane() const {
  const auto good = [](double x) { return std::isfinite(x) && x >= 0 && x < 1e9; };
  for (const Cost* cost : {&hostPairs, &hostPairwise, &hostSolid, &devicePairs, &devicePairwise, &batchPair}) {
    if (!good(cost->fixed) || !good(cost->perTriangle) || !(cost->fixed + cost->perTriangle > 0)) return false;
  }
  if (!good(deviceSolid.fixed) || !good(deviceSolid.perTriangle)) return false;
  if (!good(batchSolid.fixed) || !good(batchSolid.perTriangle) || !good(solidLaunch)) return false;
  for (const Cost* cost : {&batchLarge, &hostLarge}) {
    if (!good(cost->fixed) || !good(cost->perTriangle)) return false;
    if (largeWork > 0 && !(cost->fixed + cost->perTriangle > 0)) return false;
  }
  if (!good(largeWork)) return false;
  for (const Cost* cost : {&hostNearest, &hostInside, &deviceNearest, &deviceInside, &pointLaunch, &hostRay, &deviceRay,
                           &rayLaunch, &hostOverlap, &batchOverlap, &hostDistance, &batchDistance}) {
    if (!good(cost->fixed) || !good(cost->perTriangle)) return false;
  }
  if (!good(pointFinish) || !good(rayFinish) || !good(overlapLaunch) || !good(distanceLaunch)) return false;
  return good(batchLaunch) && good(hostThreads) && hostThreads >= 1 && good(hostSpeedup) && hostSpeedup >= 1;
}

double CostModel::speedup(unsigned threads) const {
  if (threads <= 1 || hostThreads <= 1) return 1;
  // A line from one thread to as many as were measured. More than that are no quicker: they are as many as there are
  // cores.
  const double part = std::min(1.0, (threads - 1) / (hostThreads - 1));
  return 1 + part * (hostSpeedup - 1);
}

CostModel assumedCosts() {
  constexpr Cost kPair{2, 0.01};  // of 200 triangles
  CostModel model;
  for (Cost* const cost : {&model.hostPairs, &model.hostPairwise, &model.hostSolid, &model.devicePairs,
                           &model.devicePairwise, &model.deviceSolid, &model.batchPair, &model.batchSolid}) {
    *cost = kPair;
  }
  return model;
}

std::vector<unsigned char> toBytes(const CostModel& model) {
  static_assert(sizeof(CostModel) == 53 * sizeof(double));
  std::vector<unsigned char> bytes(sizeof kMagic + sizeof model);
  std::memcpy(bytes.data(), kMagic, sizeof kMagic);
  std::memcpy(bytes.data() + sizeof kMagic, &model, sizeof model);
  return bytes;
}

std::optional<CostModel> costModelFrom(const std::vector<unsigned char>& bytes) {
  CostModel model;
  if (bytes.size() != sizeof kMagic + sizeof model || std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0) {
    return std::nullopt;
  }
  std::memcpy(&model, bytes.data() + sizeof kMagic, sizeof model);
  return model.isSane() ? std::optional(model) : std::nullopt;
}

void fitSolids(const std::vector<SolidTime>& measured, const std::vector<std::pair<double, double>>& onHost,
               CostModel& model) {
  std::vector<SolidTime> sorted = measured;
  std::sort(sorted.begin(), sorted.end(), [](const SolidTime& x, const SolidTime& y) { return x.work < y.work; });
  // Between which two: those before count as not described, those from there on as described.
  std::size_t wrong = static_cast<std::size_t>(
      std::count_if(sorted.begin(), sorted.end(), [](const SolidTime& t) { return !t.described; }));
  std::size_t fewest = wrong, first = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    wrong = sorted[i].described ? wrong + 1 : wrong - 1;
    const bool isEnd = i + 1 == sorted.size() || sorted[i + 1].work > sorted[i].work;
    if (isEnd && wrong < fewest) {
      fewest = wrong;
      first = i + 1;
    }
  }
  std::vector<std::pair<double, double>> lines[2], hostLines[2];
  for (std::size_t i = 0; i < sorted.size(); ++i) lines[i < first ? 0 : 1].emplace_back(sorted[i].work, sorted[i].time);
  const bool split = !lines[0].empty() && !lines[1].empty();
  const double between = split ? std::sqrt(std::max(sorted[first - 1].work, 1.0) * sorted[first].work) : 0;
  for (const auto& point : onHost) hostLines[split && point.first >= between ? 1 : 0].push_back(point);
  const bool both = split && !hostLines[0].empty() && !hostLines[1].empty();
  if (split && !both) {
    lines[0].insert(lines[0].end(), lines[1].begin(), lines[1].end());
    hostLines[0] = onHost;
  }
  model.batchSolid = fitCost(lines[0].empty() ? lines[1] : lines[0]);
  model.hostSolid = fitCost(hostLines[0]);
  model.batchLarge = both ? fitCost(lines[1]) : Cost{};
  model.hostLarge = both ? fitCost(hostLines[1]) : Cost{};
  model.largeWork = both ? between : 0;
}

Cost fitCost(const std::vector<std::pair<double, double>>& measured) {
  // Minimises the sum of ((f + p w - t) / t)^2.
  double s = 0, sw = 0, sww = 0, st = 0, swt = 0;
  for (const auto& [w, t] : measured) {
    if (!(t > 0)) continue;
    const double weight = 1 / (t * t);
    s += weight;
    sw += weight * w;
    sww += weight * w * w;
    st += weight * t;
    swt += weight * w * t;
  }
  const double determinant = s * sww - sw * sw;
  Cost cost;
  if (determinant > 1e-12 * s * sww) {
    cost.fixed = (sww * st - sw * swt) / determinant;
    cost.perTriangle = (s * swt - sw * st) / determinant;
  }
  if (!(determinant > 1e-12 * s * sww) || cost.perTriangle < 0) {
    cost = {s > 0 ? st / s : 0, 0};
  } else if (cost.fixed < 0) {
    cost = {0, sww > 0 ? swt / sww : 0};
  }
  return cost;
}

}  // namespace otg
