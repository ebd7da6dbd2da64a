# SPDX-License-Identifier: BSD-3-Clause
# What this layer decides without a device.
otg_add_test(batch_routing unit SOURCES test_batch_routing.cpp LIBRARIES otg_scenes)
find_package(Threads REQUIRED)
otg_add_test(memory_budget unit SOURCES test_memory_budget.cpp LIBRARIES Threads::Threads)
otg_add_test(register_limit unit SOURCES test_register_limit.cpp)
otg_add_test(free_places unit SOURCES test_free_places.cpp)
otg_add_test(records_by_pair unit SOURCES test_records_by_pair.cpp LIBRARIES Threads::Threads)
