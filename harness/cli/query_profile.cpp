// SPDX-License-Identifier: BSD-3-Clause
#include "cli/query_profile.h"

#include <algorithm>

#include "cli/times.h"
#include "collide/stages.h"

namespace otg::cli {

std::vector<QueryStage> withHost(std::vector<QueryStage> stages, double total) {
  double known = 0;
  for (const QueryStage& stage : stages) known += stage.ms;
  stages.push_back({"host", std::max(0.0, total - known), 0});
  const double whole = std::max(total, known);
  for (QueryStage& stage : stages) stage.percent = whole > 0 ? 100 * stage.ms / whole : 0;
  return stages;
}

QueryTimes measureQuery(const Query& query, Workspace& workspace, int repeat) {
  QueryTimes times;
  collide(query, workspace);  // warm-up: memory is allocated, layouts other than the standard one are made
  times.total = repeatTimes(repeat, [&] {
    const double ms = timeOnce([&] { collide(query, workspace); });
    times.main.push_back(workspace.stats.middleMs);
    times.near.push_back(workspace.stats.nearMs);
    times.contacts.push_back(workspace.stats.contactsMs);
    times.reduction.push_back(workspace.stats.reductionMs);
    return ms;
  });
  return times;
}

QueryTimes measureQuery(opencl::Backend& backend, const Query& query, Workspace& workspace, int repeat) {
  QueryTimes times;
  opencl::StageTimes stages;
  const double first = timeOnce([&] { backend.collide(query, workspace); });
  times.uploadOnce = std::max(0.0, first - timeOnce([&] { backend.collide(query, workspace); }));
  backend.collideProfiled(query, workspace, stages);
  times.total = repeatTimes(repeat, [&] {
    const double ms = timeOnce([&] { backend.collide(query, workspace); });
    backend.collideProfiled(query, workspace, stages);
    times.profiled.push_back(stages.total);
    times.top.push_back(stages.top);
    times.main.push_back(stages.levels + stages.main);
    times.upload.push_back(stages.write);
    times.contacts.push_back(stages.contacts);
    times.readBack.push_back(stages.readBack);
    times.host.push_back(stages.host);
    times.reduction.push_back(stages.regions + stages.select + stages.choose + stages.reduction);
    return ms;
  });
  return times;
}

CollideStats countsOf(const Query& query, const CollideStats& stats) {
  if (!mayNeedNoTriangles(query) || stats.boxTests > 0 || stats.candidatePairs > 0) return stats;
  Workspace workspace;
  findIntersectingPairs(query, workspace);
  CollideStats counts = workspace.stats;
  counts.contactsBeforeReduction = stats.contactsBeforeReduction;
  return counts;
}

std::vector<QueryStage> stagesOf(const QueryTimes& times) {
  return withHost({{"upload", median(times.upload), 0},
                   {"top", median(times.top), 0},
                   {"main", median(times.main), 0},
                   {"near", median(times.near), 0},
                   {"contacts", median(times.contacts), 0},
                   {"reduction", median(times.reduction), 0},
                   {"read-back", median(times.readBack), 0}},
                  median(times.total));
}

const StageTexts kStagesOnCpu = {"nothing is sent",
                                 "nothing: the mid phase begins at the roots",
                                 "mid phase: which triangles may meet",
                                 "narrow phase: which of them do",
                                 "positions, normals and depths",
                                 "of the contacts of pairwise, the few that were asked for",
                                 "nothing is read back",
                                 "what lies between the stages"};
const StageTexts kStagesOnDevice = {"meshes stay on the device; poses go with the launches",
                                    "device: where the traversal begins",
                                    "device: the rest of the traversal, with the float filter of the narrow phase",
                                    "in main and contacts",
                                    "device: decisions in double, and contacts",
                                    "device: regions, bins, limit; CPU: what it left",
                                    "device: results to the CPU",
                                    "CPU: launches, waiting, order, exact decisions"};
const StageTexts kStagesByLevels = {"to the device: the nodes to start from; trees and triangles with --send-trees",
                                    "device: the pairs of nodes to start from",
                                    "device: the traversal, level by level; its steps are below",
                                    "device: triangles, and contacts unless --split-near",
                                    "device: decisions in double, and contacts, with --split-near",
                                    "device: regions, bins, limit; CPU: what it left",
                                    "device: lengths of lists after each level; results",
                                    "CPU: launches, waiting, order, exact decisions"};

StageTexts solidStageTexts() {
  StageTexts texts = kStagesOnDevice;
  texts.contacts = "device: exact decisions, crossings and chords";
  texts.reduction =
      "device: regions, surface, candidates, where there are many hits; CPU: contacts from that, or from hits";
  texts.readBack = "device: what it found, to the CPU";
  return texts;
}

StageTexts mixedStageTexts(bool middleOnDevice, bool nearOnDevice) {
  StageTexts texts = kStagesOnCpu;
  texts.upload = texts.readBack = "in the times of the phases";
  texts.main = middleOnDevice ? "mid phase, on the device" : "mid phase, on the CPU";
  texts.near = nearOnDevice ? "narrow phase, on the device" : "narrow phase, on the CPU";
  return texts;
}

Json profileRows(const QueryTimes& times, const StageTexts& texts) {
  const char* const what[] = {texts.upload,   texts.top,       texts.main,     texts.near,
                              texts.contacts, texts.reduction, texts.readBack, texts.host};
  Json rows = Json::array();
  for (const QueryStage& stage : stagesOf(times)) {
    rows.push_back({{"stage", stage.name}, {"ms", stage.ms}, {"percent", stage.percent}, {"what", what[rows.size()]}});
  }
  return rows;
}

}  // namespace otg::cli
