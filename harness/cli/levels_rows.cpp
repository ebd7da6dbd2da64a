// SPDX-License-Identifier: BSD-3-Clause
#include "cli/levels_rows.h"

namespace otg::cli {

opencl::LevelsTimes medianOf(const std::vector<opencl::LevelsTimes>& times) {
  using T = opencl::LevelsTimes;
  opencl::LevelsTimes out;
  for (double T::*member : {&T::upload, &T::start, &T::test, &T::scan, &T::compaction, &T::split, &T::spawn, &T::near,
                            &T::contacts, &T::regions, &T::choose, &T::readBack, &T::host, &T::reduction, &T::total}) {
    std::vector<double> values;
    values.reserve(times.size());
    for (const T& one : times) values.push_back(one.*member);
    out.*member = median(values);
  }
  return out;
}

std::vector<QueryStage> stagesOf(const opencl::LevelsTimes& t, double total) {
  return withHost({{"upload", t.upload, 0},
                   {"start", t.start, 0},
                   {"test", t.test, 0},
                   {"scan", t.scan, 0},
                   {"compaction", t.compaction, 0},
                   {"split", t.split, 0},
                   {"spawn", t.spawn, 0},
                   {"near", t.near, 0},
                   {"contacts", t.contacts, 0},
                   {"reduction", t.regions + t.choose + t.reduction, 0},
                   {"read_back", t.readBack, 0}},
                  total);
}

Json depthRows(const std::vector<opencl::LevelsStep>& steps, const Json& before) {
  Json rows = Json::array();
  for (const opencl::LevelsStep& step : steps) {
    Json row = before;
    row["depth"] = step.depth;
    row["box_tests"] = step.tests;
    row["overlapping"] = step.overlapping;
    row["leaf_pairs"] = step.leafPairs;
    row["spawned"] = step.spawned;
    rows.push_back(row);
  }
  return rows;
}

}  // namespace otg::cli
