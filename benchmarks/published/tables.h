// SPDX-License-Identifier: BSD-3-Clause
// The tables 6.1 to 6.5 and the figures 6.2 and 6.3 of the published work, in their own form.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/mixture.h"
#include "otg_bench/scene.h"

namespace otg::cli {

/// What the published work reports of one size of its body: a Core2 of 2.13 GHz and a GeForce 8800 GTS, milliseconds.
struct PublishedSize {
  std::uint32_t triangles, candidates;
  double middleCpu, middleGpu, nearCpu, nearGpu;
};
/// Of exactly so many triangles.
std::optional<PublishedSize> publishedSize(std::uint64_t triangles);

/// Columns that add up to 100 percent.
struct StackedColumns {
  std::string title;
  struct Column {
    std::string name;
    std::vector<QueryStage> parts;
  };
  std::vector<Column> columns;
};
/// Throws InputError.
void writeSvg(const StackedColumns& figure, const std::string& file);

/// One body in several sizes, each with a copy of itself.
class PublishedTables {
 public:
  /// `backend` may be null: columns of a GPU are empty then.
  PublishedTables(opencl::Backend* backend, int repeat);
  /// `mesh` has a tree that was built as published.
  void add(const std::string& name, const CollisionMesh& mesh, const Transformd& pose);
  /// Tables, what they say, and figures, which are written to `folder` unless that is empty.
  void addTo(Json& document, const std::string& folder) const;

 private:
  struct Size {
    std::string name;
    std::uint64_t triangles = 0, candidates = 0;
    double middleCpu = 0, nearCpu = 0;
    std::optional<MixtureRun> gpu;  ///< as published: trees sent, contacts first
  };
  void addCounts(const Size& size, const Query& query, const Workspace& workspace);
  void addTimes(const Size& size, const Query& query);
  void addMixtures(const Size& size, const Query& query, const std::string& hash);
  std::vector<std::string> sentences() const;
  StackedColumns shares(bool near) const;

  opencl::Backend* backend_;
  int repeat_;
  std::vector<Size> sizes_;
  Json objects_ = Json::array(), middle_ = Json::array(), depths_ = Json::array(), candidates_ = Json::array();
  Json near_ = Json::array(), sums_ = Json::array(), mixtures_ = Json::array();
};

}  // namespace otg::cli
