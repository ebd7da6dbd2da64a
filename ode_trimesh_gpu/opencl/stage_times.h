// SPDX-License-Identifier: BSD-3-Clause
// Where the time of queries goes. Free of OpenCL's types, for layers above.
#pragma once

namespace otg::opencl {

/// Where the time of one query or batch went, in milliseconds. Those from `write` to `readBack` are the device's clock,
/// each with what the device takes to begin and end a kernel.
struct StageTimes {
  double fill = 0;        ///< poses to memory that the device reads (batches)
  double write = 0;       ///< poses to the device (batches)
  double top = 0;         ///< cut against cut; for a batch: frames from poses
  double levels = 0;      ///< both nodes opened, two levels
  double main = 0;        ///< the rest of the traversal, with the float filter of the near phase in it
  double contacts = 0;    ///< decisions in double, and contacts
  double regions = 0;     ///< regions of contact, and bins
  double select = 0;      ///< the best of the bins, listed
  double choose = 0;      ///< the limit, and results in order
  double weigh = 0;       ///< large regions: pieces, points, and what they say
  double ways = 0;        ///< the ways out of the regions of solids
  double candidates = 0;  ///< and their candidates, with the uneven ones in batches
  double readBack = 0;    ///< of the results
  double host = 0;        ///< what the device left: decisions in exact arithmetic, order, regions; and copying
  double reduction = 0;   ///< on the CPU; with the contacts where the CPU makes them
  double total = 0;       ///< from call to return, with launches and what lies between stages
};

}  // namespace otg::opencl
