// SPDX-License-Identifier: BSD-3-Clause
// The part of `otg bench thesis` that runs on an OpenCL device.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "opencl/backend.h"
#include "otg_bench/scene.h"

namespace otg::cli {

/// The published traversal `levels`, whole queries with `pairwise` contacts and binning, on the default device.
class LevelsBench {
 public:
  LevelsBench();
  /// The trees of one mesh, in every scene that the options request.
  void add(const BenchOptions& options, const std::string& name,
           const std::vector<std::shared_ptr<const CollisionMesh>>& meshes);
  /// levels, levels_shares, levels_per_depth; none without a device.
  void addTablesTo(Json& document) const;
  /// The default device; null without one.
  opencl::Backend* backend() const { return backend_.get(); }

 private:
  void addScene(int repeat, const std::string& name, const std::string& scene, const CollisionMesh& mesh,
                const Transformd& pose, bool withDepths);
  std::shared_ptr<opencl::Backend> backend_;
  Json queries_ = Json::array(), shares_ = Json::array(), depths_ = Json::array();
};

}  // namespace otg::cli
