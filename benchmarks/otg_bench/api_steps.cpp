// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/api_steps.h"

#include <optional>

#include "dispatch/dispatcher.h"
#include "ode/many/pair_batch.h"
#include "otg_bench/scene.h"

namespace otg::cli {

Json collideSteps(const std::vector<dGpuTriMeshPair>& pairs, int places, int repeat, bool onDevice) {
  std::vector<dContactGeom> contacts(pairs.size() * static_cast<std::size_t>(places));
  std::vector<int> counts(pairs.size());
  std::vector<double> read, computed, device, written;
  for (int i = 0; i <= repeat; ++i) {
    std::optional<PairBatch> batch;
    const double first = timeOnce([&] { batch.emplace(pairs, PairBatchRequest{places}); });
    const double second = timeOnce([&] { batch->run(); });
    const double third = timeOnce([&] {
      rememberInto(*batch, {places, contacts.data(), sizeof(dContactGeom), counts.data()});
      batch.reset();
    });
    if (i == 0) continue;  // warms up
    read.push_back(first);
    computed.push_back(second);
    written.push_back(third);
    for (const auto& slot : dispatcher().devices()) {
      if (onDevice) device.push_back(slot->blockMs);
    }
  }
  return {{"geoms_read_ms", median(read)},
          {"computed_ms", median(computed)},
          {"device_ms", device.empty() ? Json() : Json(median(device))},
          {"contacts_written_ms", median(written)}};
}

}  // namespace otg::cli
