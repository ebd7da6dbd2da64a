// SPDX-License-Identifier: BSD-3-Clause
// How many candidates, intersecting pairs and contacts named scenes have, against the numbers in contact_counts.txt.
// What is right is for other tests to say (the oracle tests above all); this one says when something changed.
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "collide/pairwise/reduction.h"
#include "collide/query.h"
#include "golden/named_scenes.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

constexpr const char* kHeader =
    "# Counts of named scenes; see test_contact_counts.cpp. The candidates depend on the default tree and traversal "
    "and\n"
    "# change with them; the columns after them do not.\n"
    "# scene candidates intersecting contacts regions after_binning after_cone\n";

std::string countsOf(const NamedScene& scene) {
  const CollisionMesh a(build(scene.a), BuildStrategy::kSah), b(build(scene.b), BuildStrategy::kSah);
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = scene.bInA;
  Workspace workspace;
  collide(query, workspace);
  std::uint32_t regions = 0;
  for (const Contact& c : workspace.contacts) regions = std::max(regions, c.region + 1);
  std::ostringstream line;
  line << scene.name << ' ' << workspace.candidates.size() << ' ' << workspace.intersecting.size() << ' '
       << workspace.contacts.size() << ' ' << regions << ' '
       << reduceByBinning(workspace.contacts, query.options.reduction.bins).size() << ' '
       << reduceToCone(workspace.contacts).size();
  return line.str();
}

}  // namespace

TEST_CASE("the counts of the named scenes are those in contact_counts.txt") {
  std::vector<std::string> lines;
  for (const NamedScene& scene : namedScenes()) lines.push_back(countsOf(scene));
  checkGolden(OTG_CONTACT_COUNTS, kHeader, lines);
}
