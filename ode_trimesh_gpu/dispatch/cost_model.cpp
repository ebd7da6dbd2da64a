// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/cost_model.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace otg {
namespace {

constexpr char kMagic[8] = {'o', 't', 'g', 'c', 'o', 's', 't', '7'};

/// The part of a surface that lies in a part of its box: areas go with the square of lengths.
double surfaceIn(const double part[3], const double whole[3]) {
  double fraction = 1;
  for (int k = 0; k < 3; ++k) {
    if (part[k] <= 0) return 0;
    if (whole[k] > 0) fraction *= std::min(1.0, part[k] / whole[k]);
  }
  return std::cbrt(fraction * fraction);
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
  const double work = static_cast<double>(a.triangleCount()) * surfaceIn(part, sizeA) +
                      static_cast<double>(b.triangleCount()) * surfaceIn(part, sizeB);
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
  for (const Cost* cost : {&hostNearest, &hostInside, &deviceNearest, &deviceInside, &pointLaunch, &hostRay, &deviceRay,
                           &rayLaunch, &hostOverlap, &batchOverlap}) {
    if (!good(cost->fixed) || !good(cost->perTriangle)) return false;
  }
  if (!good(pointFinish) || !good(rayFinish) || !good(overlapLaunch)) return false;
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
  static_assert(sizeof(CostModel) == 43 * sizeof(double));
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
