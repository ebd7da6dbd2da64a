// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/height_samples.h"
#include "base/fork_gate.h"

#include <ode/error.h>

#include <cmath>
#include <set>
#include <unordered_map>

namespace otg {
namespace {

/// What is kept of one field: as many blocks, and as many samples in all of them, the last block not counted.
constexpr std::size_t kMostBlocks = 256, kMostKeptSamples = std::size_t{1} << 20;

std::size_t sizeOfSample(int type) {
  switch (type) {
    case dGPUTRIMESH_HEIGHTS_BYTE:
      return 1;
    case dGPUTRIMESH_HEIGHTS_SHORT:
      return sizeof(short);
    case dGPUTRIMESH_HEIGHTS_SINGLE:
      return sizeof(float);
    default:
      return sizeof(double);
  }
}

/// The sample that ODE takes for this number: the nearest one of a field that ends, the one a period away of one that
/// does not.
int sampleOf(int number, int count, bool wraps) {
  if (!wraps) return number < 0 ? 0 : number < count ? number : count - 1;
  const int rest = number % (count - 1);
  return rest < 0 ? rest + count - 1 : rest;
}

struct Registry {
  std::mutex mutex;
  std::unordered_map<dHeightfieldDataID, std::shared_ptr<HeightSamples>> known;
  std::set<dHeightfieldDataID> warned;
};

/// Never destroyed: geoms may collide in the destructors of a program's own globals.
Registry& registry() {
  static Registry* const instance = new Registry;
  return *instance;
}

}  // namespace

HeightSamples::HeightSamples(const dGpuTriMeshHeightfield& field)
    : field_(field),
      columnWidth_(field.width / (field.width_samples - dReal(1))),
      rowDepth_(field.depth / (field.depth_samples - dReal(1))) {
  if (field.type == dGPUTRIMESH_HEIGHTS_CALLBACK || field.copy == 0) return;
  const auto* const bytes = static_cast<const unsigned char*>(field.heights);
  copy_.assign(bytes, bytes + sizeOfSample(field.type) * static_cast<std::size_t>(field.width_samples) *
                                  static_cast<std::size_t>(field.depth_samples));
  field_.heights = copy_.data();
}

template <class HeightOf>
void HeightSamples::readWith(const SampleRange& range, HeightBlock& block, const HeightOf& heightOf) const {
  std::vector<int> columns;
  for (int i = range.firstColumn; i <= range.lastColumn; ++i) columns.push_back(sampleOf(i, this->columns(), wraps()));
  for (int j = range.firstRow; j <= range.lastRow; ++j) {
    const int row = sampleOf(j, rows(), wraps());
    for (const int column : columns) {
      const auto raw = static_cast<dReal>(heightOf(column, row));
      block.heights.push_back(static_cast<double>(raw * field_.scale + field_.offset));
    }
  }
}

void HeightSamples::read(const SampleRange& range, HeightBlock& block) const {
  block.columns = range.lastColumn - range.firstColumn + 1;
  block.rows = range.lastRow - range.firstRow + 1;
  block.columnWidth = columnWidth_;
  block.rowDepth = rowDepth_;
  block.heights.clear();
  block.heights.reserve(static_cast<std::size_t>(block.columns) * static_cast<std::size_t>(block.rows));
  const auto ofArray = [&](const auto* heights) {
    readWith(range, block, [&](int i, int j) {
      return heights[static_cast<std::size_t>(i) + static_cast<std::size_t>(j) * static_cast<std::size_t>(columns())];
    });
  };
  switch (field_.type) {
    case dGPUTRIMESH_HEIGHTS_CALLBACK:
      readWith(range, block, [&](int i, int j) { return field_.callback(field_.user_data, i, j); });
      break;
    case dGPUTRIMESH_HEIGHTS_BYTE:
      ofArray(static_cast<const unsigned char*>(field_.heights));
      break;
    case dGPUTRIMESH_HEIGHTS_SHORT:
      ofArray(static_cast<const short*>(field_.heights));
      break;
    case dGPUTRIMESH_HEIGHTS_SINGLE:
      ofArray(static_cast<const float*>(field_.heights));
      break;
    default:
      ofArray(static_cast<const double*>(field_.heights));
      break;
  }
}

HeightBlockMesh HeightSamples::ground(const SampleRange& range, HeightBlock&& block) {
  std::shared_ptr<const Kept> before;
  {
    const CallLock lock(mutex_);
    for (auto it = kept_.begin(); it != kept_.end(); ++it) {
      // The bottom belongs to the question, not to the field.
      if (!((*it)->range == range) || (*it)->block.bottom != block.bottom) continue;
      kept_.splice(kept_.begin(), kept_, it);
      before = kept_.front();
      break;
    }
  }
  if (before != nullptr && before->block.heights == block.heights) return before->mesh;
  // Two threads may come here at once; they make the same, and one is kept.
  const auto made = std::make_shared<Kept>();
  made->range = range;
  // Refitted to what was there before, a mesh would depend on what that was: its tree would, its contacts do not.
  made->mesh =
      before != nullptr && before->mesh.mesh != nullptr ? moveBlock(block, *before->mesh.mesh) : meshOfBlock(block);
  made->block = std::move(block);
  const CallLock lock(mutex_);
  kept_.remove_if([&](const auto& kept) {
    if (!(kept->range == range) || kept->block.bottom != made->block.bottom) return false;
    keptSamples_ -= kept->block.heights.size();
    return true;
  });
  while (!kept_.empty() && (kept_.size() >= kMostBlocks || keptSamples_ > kMostKeptSamples)) {
    keptSamples_ -= kept_.back()->block.heights.size();
    kept_.pop_back();
  }
  kept_.push_front(made);
  keptSamples_ += made->block.heights.size();
  return made->mesh;
}

std::shared_ptr<HeightSamples> samplesOf(dHeightfieldDataID data) {
  Registry& all = registry();
  const CallLock lock(all.mutex);
  const auto it = all.known.find(data);
  return it == all.known.end() ? nullptr : it->second;
}

int describeHeights(dHeightfieldDataID data, const dGpuTriMeshHeightfield& field) {
  const auto samples = std::make_shared<HeightSamples>(field);
  Registry& all = registry();
  const CallLock lock(all.mutex);
  all.known[data] = samples;
  all.warned.erase(data);
  return dGPUTRIMESH_OK;
}

void forgetHeights(dHeightfieldDataID data) noexcept {
  std::shared_ptr<HeightSamples> last;  // goes after the lock
  Registry& all = registry();
  const CallLock lock(all.mutex);
  all.warned.erase(data);
  const auto it = all.known.find(data);
  if (it == all.known.end()) return;
  last = std::move(it->second);
  all.known.erase(it);
}

void forgetAllHeights() noexcept {
  Registry& all = registry();
  const CallLock lock(all.mutex);
  all.known.clear();
  all.warned.clear();
}

void warnOfUnknownHeights(dHeightfieldDataID data) {
  {
    Registry& all = registry();
    const CallLock lock(all.mutex);
    if (!all.warned.insert(data).second) return;
  }
  dMessage(0,
           "ode_trimesh_gpu: a mesh meets a heightfield whose heights are not known, and there are no contacts: build "
           "its data with dGpuTriMeshHeightfieldDataBuild...() or tell of them with "
           "dGpuTriMeshHeightfieldDataDescribe()");
}

}  // namespace otg
