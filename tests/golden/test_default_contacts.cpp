// SPDX-License-Identifier: BSD-3-Clause
// The contacts that ODE's dCollide gives for named scenes when nothing was chosen, against the numbers in
// default_contacts.txt; on the CPU, and, as the same source once more, on an OpenCL device.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "golden/named_scenes.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr const char* kHeader =
    "# Contacts of named scenes through ODE; see test_default_contacts.cpp. The last three columns are the mean "
    "normal.\n"
    "# scene contacts deepest x y z\n";

std::string contactsOf(const NamedScene& scene) {
  const Data dataA(scene.a), dataB(scene.b);
  const Geom a(dataA), b(dataB);
  setPose(b.id, scene.bInA);
  const std::vector<dContactGeom> contacts = collide(a.id, b.id, 64);
  double deepest = 0;
  Vec3d mean{0, 0, 0};
  for (const dContactGeom& c : contacts) {
    deepest = std::max(deepest, static_cast<double>(c.depth));
    mean = otgAdd(mean, {c.normal[0], c.normal[1], c.normal[2]});
  }
  const double scale = contacts.empty() ? 0 : 1.0 / static_cast<double>(contacts.size());
  // Adding zero leaves no minus before a zero.
  const auto rounded = [&](double x) { return std::round(1000 * scale * x) / 1000 + 0.0; };
  char line[200];
  std::snprintf(line, sizeof line, "%s %zu %.4g %.3f %.3f %.3f", scene.name, contacts.size(), deepest, rounded(mean.x),
                rounded(mean.y), rounded(mean.z));
  return line;
}

}  // namespace

TEST_CASE("the contacts of the named scenes are those in default_contacts.txt") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshSetBackend(OTG_GOLDEN_BACKEND) == dGPUTRIMESH_OK);
  std::vector<std::string> lines;
  for (const NamedScene& scene : namedScenes()) lines.push_back(contactsOf(scene));
  checkGolden(OTG_DEFAULT_CONTACTS, kHeader, lines);
}
