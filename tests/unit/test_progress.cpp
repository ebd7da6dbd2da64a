// SPDX-License-Identifier: BSD-3-Clause
// What long runs say of how much is done.
#include "cli/progress.h"
#include "support/catch.h"

using otg::cli::Progress;
using otg::cli::progressInWords;
using std::chrono::duration;

TEST_CASE("steps within a step are parts of it") {
  Progress all(4);
  CHECK(all.share() == 0);
  all.step();
  {
    Progress parts(2);
    CHECK(parts.share() == 0.25);
    parts.step();
    CHECK(parts.share() == 0.375);
    Progress parcels(5);
    parcels.step();
    CHECK(parcels.share() == 0.4);
    for (int i = 0; i < 9; ++i) parcels.step();  // more than it was made for
    CHECK(parcels.share() == 0.5);
  }
  CHECK(all.share() == 0.25);
  for (int i = 0; i < 3; ++i) all.step();
  CHECK(all.share() == 1);
  CHECK(Progress(0).share() == 1);  // within the run that is done
}

TEST_CASE("the time that is left follows from the share that is done") {
  CHECK(progressInWords(0.4, duration<double>(12)) == "40 % done after 12 s, about 18 s left");
  CHECK(progressInWords(0.1, duration<double>(120)) == "10 % done after 2 min, about 18 min left");
  CHECK(progressInWords(0.5, duration<double>(9000)) == "50 % done after 2.5 h, about 2.5 h left");
  CHECK(progressInWords(0.01, duration<double>(20)) == "1 % done after 20 s");
}
