// SPDX-License-Identifier: BSD-3-Clause
// The heights of a dHeightfieldDataID, which ODE itself does not expose, and what is kept of its ground.
#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <vector>

#include "ode_trimesh_gpu/heightfield.h"
#include "ode_trimesh_gpu/library.h"
#include "primitives/height_block.h"

namespace otg {

/// Samples of a field by their numbers along x and z, the last ones included.
struct SampleRange {
  int firstColumn = 0, lastColumn = 0, firstRow = 0, lastRow = 0;
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

/// Immutable but for what it keeps; any number of threads. Heights are read as often as they are requested, from the
/// program's own array or callback, as ODE does.
class HeightSamples {
 public:
  /// The description is complete. May throw std::bad_alloc.
  explicit HeightSamples(const dGpuTriMeshHeightfield& field);

  double columnWidth() const { return columnWidth_; }
  double rowDepth() const { return rowDepth_; }
  double halfWidth() const { return 0.5 * field_.width; }
  double halfDepth() const { return 0.5 * field_.depth; }
  int columns() const { return field_.width_samples; }
  int rows() const { return field_.depth_samples; }
  bool wraps() const { return field_.wrap != 0; }

  /// Fills in everything but the bottom.
  void read(const SampleRange& range, HeightBlock& block) const;

  /// The ground of a range: kept from an earlier question if its heights are the same, refitted if they have changed.
  /// May throw std::bad_alloc.
  HeightBlockMesh ground(const SampleRange& range, HeightBlock&& block);

 private:
  template <class HeightOf>
  void readWith(const SampleRange& range, HeightBlock& block, const HeightOf& heightOf) const;

  struct Kept {
    SampleRange range;
    HeightBlock block;
    HeightBlockMesh mesh;
  };
  dGpuTriMeshHeightfield field_;
  std::vector<unsigned char> copy_;
  double columnWidth_, rowDepth_;
  std::mutex mutex_;
  std::list<std::shared_ptr<const Kept>> kept_;  ///< requested last comes first
  std::size_t keptSamples_ = 0;
};

/// Null for data whose heights have not been described.
std::shared_ptr<HeightSamples> samplesOf(dHeightfieldDataID data);
/// Takes over a description that is complete; ODE's own function is not called. Returns a status. May throw
/// std::bad_alloc.
int describeHeights(dHeightfieldDataID data, const dGpuTriMeshHeightfield& field);
void forgetHeights(dHeightfieldDataID data) noexcept;
void forgetAllHeights() noexcept;
/// Says once for each of them that heights are not known.
void warnOfUnknownHeights(dHeightfieldDataID data);

}  // namespace otg
