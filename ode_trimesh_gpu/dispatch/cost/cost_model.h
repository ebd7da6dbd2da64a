// SPDX-License-Identifier: BSD-3-Clause
// How long a pair is expected to take, on one thread of the CPU and on one device.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "collide/query.h"

namespace otg {

/// Triangles of both meshes that lie where their boxes overlap, and the balls around them, as far as these show: what
/// the time of a query follows. Costs less than a microsecond.
double expectedWork(const Query& query);

/// What the time of a point or ray against a mesh follows: how deep the mesh's trees are.
double pointWork(const TriMesh& mesh);

/// A time that grows with the expected work, in microseconds.
struct Cost {
  double fixed = 0, perTriangle = 0;
  double of(double work) const { return fixed + perTriangle * work; }
  friend bool operator==(const Cost&, const Cost&) = default;
};

struct CostModel {
  Cost hostPairs;       ///< mid and narrow phase on one thread
  Cost hostPairwise;    ///< the whole query, model `pairwise`
  Cost hostSolid;       ///< the same, model `solid`
  Cost devicePairs;     ///< mid and narrow phase of one pair, from call to return
  Cost devicePairwise;  ///< the whole query of one pair
  /// The same of a pair of solids, which the device describes where that pays. Zero where it is not known: then
  /// devicePairs gives it.
  Cost deviceSolid;
  double batchLaunch = 0;  ///< of a batch of `pairwise` queries, however small
  Cost batchPair;          ///< each pair of a batch that keeps the whole device busy
  /// The same two for pairs of solids. Zero where they are not known: then solids that may be computed anywhere are the
  /// CPU's.
  double solidLaunch = 0;
  Cost batchSolid;
  /// The same of pairs of solids with so much work or more, whose overlaps are so large that the device describes them,
  /// as a rule; and what these take on one thread of the CPU. largeWork is zero where that is not known, or makes no
  /// difference.
  Cost batchLarge, hostLarge;
  double largeWork = 0;
  /// One of many points against a mesh, by pointWork: its nearest triangle with the normal there, and whether it lies
  /// inside, on one thread of the CPU and on the device; and what an array takes there however small, which is as long
  /// as the longest search. Zero where they are not known: then points that may be queried anywhere are the CPU's.
  Cost hostNearest, hostInside, deviceNearest, deviceInside, pointLaunch;
  double pointFinish = 0;  ///< what one thread has to do for each nearest triangle that the device has found
  /// The same of rays.
  Cost hostRay, deviceRay, rayLaunch;
  double rayFinish = 0;
  /// Whether the meshes of a pair overlap: one of many pairs, on one thread of the CPU and on the device; and what a
  /// batch takes there however small. Zero where they are not known: then pairs that may be queried anywhere are
  /// the CPU's.
  Cost hostOverlap, batchOverlap;
  double overlapLaunch = 0;
  /// How far the meshes of a pair are apart, by distanceWork: likewise.
  Cost hostDistance, batchDistance;
  double distanceLaunch = 0;
  /// What `hostThreads` threads do at once, in units of what one does alone: they share memory and clock.
  double hostThreads = 1, hostSpeedup = 1;
  friend bool operator==(const CostModel&, const CostModel&) = default;

  bool knowsSolidPair() const { return deviceSolid.fixed + deviceSolid.perTriangle > 0; }
  bool knowsSolids() const { return batchSolid.fixed + batchSolid.perTriangle > 0; }
  bool knowsOverlaps() const { return overlapLaunch > 0; }
  bool knowsPoints() const { return pointLaunch.fixed + pointLaunch.perTriangle > 0; }
  bool knowsDistances() const { return distanceLaunch > 0; }
  bool knowsRays() const { return rayLaunch.fixed + rayLaunch.perTriangle > 0; }
  /// A pair of a batch on the device, and on one thread of the CPU.
  double deviceCost(bool solid, double work) const {
    return (!solid || !knowsSolids() ? batchPair : isLarge(work) ? batchLarge : batchSolid).of(work);
  }
  double hostCost(bool solid, double work) const {
    return (!solid ? hostPairwise : isLarge(work) ? hostLarge : hostSolid).of(work);
  }
  bool isLarge(double work) const { return largeWork > 0 && work >= largeWork; }
  /// What a batch of pairs of these models takes, however small.
  double launchCost(bool anyPairwise, bool anySolid) const {
    return (anyPairwise ? batchLaunch : 0) + (!anySolid ? 0 : knowsSolids() ? solidLaunch : batchLaunch);
  }

  /// hostSpeedup for any number of threads.
  double speedup(unsigned threads) const;
  /// All numbers are finite, none is negative, no pair is free, and more threads are not slower than one.
  bool isSane() const;
};

/// Of a device that nothing was measured of: a pair costs as much as some hundred triangles of its expected work, and
/// no less than on the CPU. Enough to cut a batch into blocks of equal cost for devices of one kind.
CostModel assumedCosts();

/// As bytes, to be stored; and back. Nothing for bytes that are not of this version or not sane.
std::vector<unsigned char> toBytes(const CostModel& model);
std::optional<CostModel> costModelFrom(const std::vector<unsigned char>& bytes);

/// Of pairs of solids: the expected work, the time, and whether the device described the overlap.
struct SolidTime {
  double work, time;
  bool described;
};
/// Sets batchSolid, batchLarge and largeWork: two lines, for less and for more work than lies between those that were
/// described and those that were not; one where only one kind was measured. Where both kinds mix, as few as can be are
/// on the wrong side. With that hostSolid and hostLarge, from (work, time) on the CPU.
void fitSolids(const std::vector<SolidTime>& measured, const std::vector<std::pair<double, double>>& onHost,
               CostModel& model);

/// The line with the least sum of squared relative errors through (work, time), with neither number negative.
Cost fitCost(const std::vector<std::pair<double, double>>& measured);

}  // namespace otg
