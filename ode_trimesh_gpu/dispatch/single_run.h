// SPDX-License-Identifier: BSD-3-Clause
// One pair, with a device at hand.
#pragma once

#include <span>

#include "dispatch/device_slot.h"
#include "dispatch/host_batch.h"

namespace otg {

/// Where the phases of a job run if there is a device: a phase that is open goes where the other one is said to go.
/// Both stay open if both are.
Placement settled(Placement place);

/// Whether the contacts of a job come from the device too, or only the pairs of triangles that intersect.
bool contactsOnDevice(const PairJob& job);

/// Whether a batch on a device makes the contacts of this job, of the model `solid`, as a rule. The device leaves some
/// to the CPU.
bool solidInBatch(const PairJob& job);

/// Whether this pair by itself is expected to be done sooner with the device.
bool isSoonerOnDevice(const PairJob& job, const CostModel& costs, double work);

/// The contacts of one job, in the workspace: both phases on the device, on the CPU, or one here and one there, as the
/// job has it. A device that fails is noted, and the CPU does the job. Throws what otg::collide throws.
std::span<const Contact> collideOn(DeviceSlot& slot, const PairJob& job, Workspace& workspace, bool& onDevice,
                                   bool& deviceFailed);

}  // namespace otg
