// SPDX-License-Identifier: BSD-3-Clause
#include "published/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "cli/levels_rows.h"
#include "cli/query_options.h"
#include "collide/stages.h"
#include "opencl/backend.h"

namespace otg::cli {
namespace {

constexpr PublishedSize kPublished[] = {{345944, 12430, 277.6, 88.8, 15.6, 8.3},
                                        {138376, 9372, 113.1, 48.9, 10.8, 6.7},
                                        {27674, 4746, 20.0, 18.4, 5.2, 4.2},
                                        {2766, 1421, 2.1, 10.2, 1.5, 1.9}};

Json ratio(double a, double b) {
  return b > 0 ? Json(a / b) : Json();
}

template <class Get>
Json ofPublished(std::uint64_t triangles, const Get& get) {
  const std::optional<PublishedSize> size = publishedSize(triangles);
  return size ? Json(get(*size)) : Json();
}

Json key(const std::string& name, std::uint64_t triangles) {
  return {{"mesh", name}, {"triangles", triangles}};
}

bool isIn(const StackedColumns& figure, const std::string& name) {
  return std::any_of(figure.columns.begin(), figure.columns.end(), [&](const StackedColumns::Column& column) {
    return std::any_of(column.parts.begin(), column.parts.end(),
                       [&](const QueryStage& part) { return part.name == name && part.percent > 0; });
  });
}

/// The largest part of all columns together.
std::string largestPart(const StackedColumns& figure, double& percent) {
  std::vector<QueryStage> sums;
  for (const StackedColumns::Column& column : figure.columns) {
    for (const QueryStage& part : column.parts) {
      const auto at = std::find_if(sums.begin(), sums.end(), [&](const QueryStage& s) { return s.name == part.name; });
      if (at == sums.end()) {
        sums.push_back(part);
      } else {
        at->percent += part.percent;
      }
    }
  }
  if (sums.empty()) return {};
  const auto most = std::max_element(sums.begin(), sums.end(),
                                     [](const QueryStage& a, const QueryStage& b) { return a.percent < b.percent; });
  percent = most->percent / static_cast<double>(figure.columns.size());
  return most->name;
}

}  // namespace

std::optional<PublishedSize> publishedSize(std::uint64_t triangles) {
  for (const PublishedSize& size : kPublished) {
    if (size.triangles == triangles) return size;
  }
  return std::nullopt;
}

PublishedTables::PublishedTables(opencl::Backend* backend, int repeat) : backend_(backend), repeat_(repeat) {}

void PublishedTables::add(const std::string& name, const CollisionMesh& mesh, const Transformd& pose) {
  Query query;
  query.a = query.b = &mesh;
  query.bInA = pose;
  query.options.timings = true;
  query.options.middle = {Traversal::kStandard, DescentRule::kBoth, 6};
  Workspace workspace;
  const QueryTimes cpu = measureQuery(query, workspace, repeat_);
  Size size;
  size.name = name;
  size.triangles = mesh.mesh().triangleCount();
  size.candidates = workspace.stats.candidatePairs;
  size.middleCpu = median(cpu.main);
  size.nearCpu = median(cpu.near) + median(cpu.contacts);
  if (backend_ != nullptr) {
    Workspace device;
    Mixture published;
    published.levels.sendTrees = true;
    size.gpu = measureMixed(*backend_, query, published, device, repeat_);
  }
  addCounts(size, query, workspace);
  addTimes(size, query);
  if (backend_ != nullptr) addMixtures(size, query, hashOf(workspace.reduced));
  sizes_.push_back(std::move(size));
}

void PublishedTables::addCounts(const Size& size, const Query& query, const Workspace& workspace) {
  Json row = key(size.name, size.triangles);
  row["vertices"] = query.a->mesh().vertices().size();
  row["nodes"] = query.a->tree().nodes.size();
  row["depth"] = query.a->tree().depth;
  row["among_the_published"] = publishedSize(size.triangles).has_value();
  objects_.push_back(row);

  const double all = double(size.triangles) * double(size.triangles);
  row = key(size.name, size.triangles);
  row["all_pairs"] = size.triangles * size.triangles;
  row["candidate_pairs"] = size.candidates;
  row["per_million_pairs"] = 1e6 * double(size.candidates) / all;
  row["candidates_for_each_triangle"] = double(size.candidates) / double(size.triangles);
  row["intersecting_pairs"] = workspace.stats.intersectingPairs;
  row["box_tests_for_each_candidate"] = ratio(double(workspace.stats.boxTests), double(size.candidates));
  row["published_candidates"] = ofPublished(size.triangles, [](const PublishedSize& p) { return p.candidates; });
  row["published_for_each_triangle"] =
      ofPublished(size.triangles, [](const PublishedSize& p) { return double(p.candidates) / p.triangles; });
  candidates_.push_back(row);

  if (!size.gpu) return;
  for (const opencl::LevelsStep& step : size.gpu->levels.steps) {
    row = key(size.name, size.triangles);
    row["depth"] = step.depth;
    row["tests"] = step.tests;
    row["overlapping"] = step.overlapping;
    row["pairs_of_leaves"] = step.leafPairs;
    row["spawned"] = step.spawned;
    depths_.push_back(row);
  }
}

void PublishedTables::addTimes(const Size& size, const Query&) {
  Json row = key(size.name, size.triangles);
  const auto gpuMiddle = size.gpu ? size.gpu->middle : 0.0, gpuNear = size.gpu ? size.gpu->near : 0.0;
  row["cpu_ms"] = size.middleCpu;
  row["gpu_ms"] = size.gpu ? Json(gpuMiddle) : Json();
  row["ratio_cpu_to_gpu"] = ratio(size.middleCpu, gpuMiddle);
  row["bytes_sent"] = size.gpu ? Json(size.gpu->levels.bytesSent) : Json();
  row["published_cpu_ms"] = ofPublished(size.triangles, [](const PublishedSize& p) { return p.middleCpu; });
  row["published_gpu_ms"] = ofPublished(size.triangles, [](const PublishedSize& p) { return p.middleGpu; });
  row["published_ratio"] =
      ofPublished(size.triangles, [](const PublishedSize& p) { return p.middleCpu / p.middleGpu; });
  middle_.push_back(row);
  row = key(size.name, size.triangles);
  row["cpu_ms"] = size.nearCpu;
  row["gpu_ms"] = size.gpu ? Json(gpuNear) : Json();
  row["ratio_cpu_to_gpu"] = ratio(size.nearCpu, gpuNear);
  row["bytes_sent"] = size.gpu ? Json(size.gpu->nearPhase.bytesSent) : Json();
  row["published_cpu_ms"] = ofPublished(size.triangles, [](const PublishedSize& p) { return p.nearCpu; });
  row["published_gpu_ms"] = ofPublished(size.triangles, [](const PublishedSize& p) { return p.nearGpu; });
  row["published_ratio"] = ofPublished(size.triangles, [](const PublishedSize& p) { return p.nearCpu / p.nearGpu; });
  near_.push_back(row);
}

void PublishedTables::addMixtures(const Size& size, const Query& query, const std::string& hash) {
  Workspace workspace;
  const std::uint64_t failed = backend_->counts().onHost;
  for (const opencl::PrefixSums way :
       {opencl::PrefixSums::kPublished, opencl::PrefixSums::kWorkEfficient, opencl::PrefixSums::kSinglePass}) {
    Mixture mixture;
    mixture.near = Mixture::Near::kCpu;
    mixture.levels.prefixSums = way;
    const MixtureRun run = measureMixed(*backend_, query, mixture, workspace, repeat_);
    const double ofMiddle = 100 * run.levels.times.scan / run.middle;
    Json row = key(size.name, size.triangles);
    row["prefix_sums"] = nameOf(way);
    row["middle_ms"] = run.middle;
    row["sums_ms"] = run.levels.times.scan;
    row["sums_percent"] = ofMiddle;
    sums_.push_back(row);
  }
  struct NamedMiddle {
    const char* name;
    Mixture::Middle middle;
    bool sent;
  };
  for (const NamedMiddle& m : {NamedMiddle{"CPU", Mixture::Middle::kCpu, false},
                               {"levels, trees sent", Mixture::Middle::kLevels, true},
                               {"levels, resident", Mixture::Middle::kLevels, false}}) {
    for (const Mixture::Near near : {Mixture::Near::kCpu, Mixture::Near::kContactsFirst, Mixture::Near::kFilterFirst}) {
      Mixture mixture;
      mixture.middle = m.middle;
      mixture.near = near;
      mixture.levels.sendTrees = m.sent;
      const MixtureRun run = measureMixed(*backend_, query, mixture, workspace, repeat_);
      Json row = key(size.name, size.triangles);
      row["middle_phase"] = m.name;
      row["near_phase"] = near == Mixture::Near::kCpu             ? "CPU"
                          : near == Mixture::Near::kContactsFirst ? "GPU, contacts first"
                                                                  : "GPU, filter first";
      row["middle_ms"] = run.middle;
      row["near_ms"] = run.near;
      row["rest_ms"] = run.rest;
      row["total_ms"] = run.total();
      row["hash"] = hashOf(workspace.reduced);
      row["answers"] = backend_->counts().onHost > failed ? "device failed"
                       : row["hash"] == hash              ? "same"
                                                          : "DIFFERENT";
      mixtures_.push_back(row);
    }
  }
}

StackedColumns PublishedTables::shares(bool near) const {
  StackedColumns figure;
  figure.title = near ? "Figure 6.3: shares of the steps of the near phase on the GPU"
                      : "Figure 6.2: shares of the steps of the middle phase on the GPU, trees sent";
  for (const Size& size : sizes_) {
    if (!size.gpu) continue;
    figure.columns.push_back(
        {fmt::format("{}", size.triangles),
         near ? stagesOf(size.gpu->nearPhase.times) : stagesOf(size.gpu->levels.times, size.gpu->middle)});
  }
  return figure;
}

std::vector<std::string> PublishedTables::sentences() const {
  std::vector<std::string> says;
  const auto winsFrom = [&](const char* what, const auto& cpu, const auto& gpu, const char* published) {
    std::uint64_t least = 0;
    for (const Size& size : sizes_) {  // largest first
      if (!size.gpu || cpu(size) < gpu(size)) break;
      least = size.triangles;
    }
    says.push_back(least > 0 ? fmt::format("- The GPU wins the {} from {} triangles on. {}", what, least, published)
                             : fmt::format("- The GPU does not win the {} of the largest size. {}", what, published));
  };
  if (!sizes_.empty() && sizes_[0].gpu) {
    winsFrom(
        "middle phase", [](const Size& s) { return s.middleCpu; }, [](const Size& s) { return s.gpu->middle; },
        "Published: it wins at 27,674 triangles and above, by 1.1 to 3.1 times, and loses at 2,766.");
    winsFrom(
        "near phase", [](const Size& s) { return s.nearCpu; }, [](const Size& s) { return s.gpu->near; },
        "Published: it wins at 27,674 triangles and above, by 1.2 to 1.9 times, and loses at 2,766.");
    for (const bool near : {false, true}) {
      double percent = 0;
      const std::string part = largestPart(shares(near), percent);
      says.push_back(fmt::format("- The largest share of the {} phase on the GPU is `{}`, {:.0f} % in the mean.",
                                 near ? "near" : "middle", part, percent));
    }
  } else {
    says.push_back("- There is no OpenCL device: columns of a GPU are empty.");
  }
  if (backend_ != nullptr && backend_->device().kind == opencl::DeviceKind::kCpu) {
    says.push_back("- The device here is a CPU: its columns show that all of it runs, and not what a GPU gains.");
  }
  if (sizes_.size() > 1) {
    const Size &most = sizes_.front(), &least = sizes_.back();
    says.push_back(fmt::format(
        "- Candidate pairs grow {:.1f} times while all pairs grow {:.0f} times: about as the length of the line in "
        "which "
        "surfaces cross, counted in triangles. Published: {:.1f} and {:.0f} times.",
        double(most.candidates) / double(std::max<std::uint64_t>(1, least.candidates)),
        double(most.triangles) * double(most.triangles) / (double(least.triangles) * double(least.triangles)),
        12430.0 / 1421, 345944.0 * 345944 / (2766.0 * 2766)));
  }
  says.push_back(
      "- The published body is the same in other sizes and another pose, on a CPU of 2010 with one core and a "
      "GeForce 8800 GTS: ratios can be compared, times cannot.");
  return says;
}

void PublishedTables::addTo(Json& document, const std::string& folder) const {
  Json tables = document["tables"];
  tables["6.1 objects"] = objects_;
  tables["6.2 middle phase alone"] = middle_;
  tables["6.3 tests for each depth"] = depths_;
  tables["6.4 candidate pairs"] = candidates_;
  tables["6.5 near phase alone"] = near_;
  tables["prefix_sums"] = sums_;
  tables["mixtures"] = mixtures_;
  Json figures = Json::array();
  for (const bool near : {false, true}) {
    const StackedColumns figure = shares(near);
    if (figure.columns.empty()) continue;
    Json rows = Json::array();
    for (const StackedColumns::Column& column : figure.columns) {
      Json row = {{"triangles", column.name}};
      for (const QueryStage& part : column.parts) {
        if (isIn(figure, part.name)) row[fmt::format("{}_percent", part.name)] = part.percent;
      }
      rows.push_back(row);
    }
    tables[near ? "figure 6.3" : "figure 6.2"] = rows;
    if (folder.empty()) continue;
    const std::string name = near ? "figure_6_3.svg" : "figure_6_2.svg";
    std::error_code error;
    std::filesystem::create_directories(folder, error);  // where that fails, so does writing
    writeSvg(figure, (std::filesystem::path(folder) / name).string());
    figures.push_back({{"title", figure.title}, {"file", name}});
  }
  document["tables"] = std::move(tables);
  document["says"] = sentences();
  if (!figures.empty()) document["figures"] = figures;
}

}  // namespace otg::cli
