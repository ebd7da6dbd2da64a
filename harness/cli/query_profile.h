// SPDX-License-Identifier: BSD-3-Clause
// Where the time of a query goes, stage by stage: what `collide --profile` and `bench thesis` show.
#pragma once

#include <vector>

#include "cli/command.h"
#include "collide/query.h"
#include "opencl/backend.h"

namespace otg::cli {

/// A stage of a query by name.
struct QueryStage {
  const char* name;
  double ms, percent;
};
/// The stages, then `host`: what is left of a query of `total` milliseconds that takes no times. Each with its share of
/// all.
std::vector<QueryStage> withHost(std::vector<QueryStage> stages, double total);

/// Times of the stages, of several queries each.
struct QueryTimes {
  std::vector<double> upload, top, main, near, contacts, readBack, host, reduction, total;
  std::vector<double> profiled;  ///< totals of the runs that the stages are from, where these are others
  double uploadOnce = 0;         ///< of both meshes, in the first query
};
/// On this thread. `repeat` as repeatTimes() takes it, after one query to warm up. The query has to request timings.
QueryTimes measureQuery(const Query& query, Workspace& workspace, int repeat);
/// On a device. The whole is timed without taking times of its stages, which costs some; these in further runs.
QueryTimes measureQuery(opencl::Backend& backend, const Query& query, Workspace& workspace, int repeat);
/// What a finished query has counted. Where it was a pair of which few or no triangles were looked at, what its first
/// two phases would have: they are run for that.
CollideStats countsOf(const Query& query, const CollideStats& stats);
/// Medians: upload, top, main, near, contacts, reduction, read-back, host.
std::vector<QueryStage> stagesOf(const QueryTimes& times);

/// What these stages stand for, where a query runs.
struct StageTexts {
  const char *upload, *top, *main, *near, *contacts, *reduction, *readBack, *host;
};
extern const StageTexts kStagesOnCpu, kStagesOnDevice, kStagesByLevels;
/// The model `solid` on a device.
StageTexts solidStageTexts();
/// Of phases on different sides only the whole times are known.
StageTexts mixedStageTexts(bool middleOnDevice, bool nearOnDevice);
/// What --profile shows: every stage, its share, and where it runs.
Json profileRows(const QueryTimes& times, const StageTexts& texts);

}  // namespace otg::cli
