// SPDX-License-Identifier: BSD-3-Clause
// Bodies that are no solids, dropped on solids and sheets: they come to rest where they fall.
#include <cstdio>
#include <cstdlib>

#include "support/catch.h"
#include "support/shell_scenes.h"

using namespace otg;
using namespace otg::test;

namespace {

enum class Ground { kSlab, kSheet, kTerrain };
constexpr std::array kGrounds = {Ground::kSlab, Ground::kSheet, Ground::kTerrain};

scenes::MeshArrays makeShellGround(Ground ground) {
  if (ground == Ground::kSlab) return scenes::makeGround(10, 1, 1);
  return ground == Ground::kSheet ? terrain(10, 1, 0) : terrain(10, 40, 0.5);
}

int count(int n, int fallback) {
  const char* text = std::getenv("SHELL_DROPS");
  return text ? std::atoi(text) : n > 0 ? n : fallback;
}

}  // namespace

TEST_CASE("shells that are dropped on a slab, a sheet and a terrain come to rest there") {
  const OdeSession session;
  const char* formText = std::getenv("SHELL_FORM");
  const GeomForm form = formText ? GeomForm::kOde : GeomForm::kOurs;
  if (formText && formText[0] == 'o') dGpuTriMeshOverrideTriMesh();
  const char* h = std::getenv("SHELL_HEIGHT");
  for (const Ground which : kGrounds) {
    const scenes::MeshArrays ground = makeShellGround(which);
    const ShellData data(ground, form);
    for (const ShellBody body : kShellBodies) {
      Draw draw(1 + static_cast<std::uint32_t>(body));
      int still = 0, n = count(0, 10);
      for (int i = 0; i < n; ++i) {
        ShellDrop drop = randomDrop(body, ground, 2.5, h ? std::atof(h) : draw.uniform(0.02, 0.3), draw);
        const ShellEnd end = letGo(data, drop, form, 600);
        const bool good = end.isStill(0.05) && end.position.z > -1;
        still += good;
        if (!good && std::getenv("SHELL_SAY"))
          std::printf("   %s on %d, %d: z %.3f v %.4f %.4f %.4f w %.4f %.4f %.4f fastest %.2f\n", nameOf(body), int(which), i, end.position.z,
                      end.velocity.x, end.velocity.y, end.velocity.z, end.spin.x, end.spin.y, end.spin.z, end.fastest);
      }
      std::printf("ground %d %-16s %d of %d\n", int(which), nameOf(body), still, n);
      CHECK(still == n);
    }
  }
}
