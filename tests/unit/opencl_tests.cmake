# SPDX-License-Identifier: BSD-3-Clause
# What this layer decides without a device.
otg_add_test(batch_routing unit SOURCES test_batch_routing.cpp LIBRARIES otg_scenes)
