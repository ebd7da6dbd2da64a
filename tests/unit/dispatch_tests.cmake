# SPDX-License-Identifier: BSD-3-Clause
find_package(Threads REQUIRED)
otg_add_test(thread_pool unit SOURCES test_thread_pool.cpp LIBRARIES Threads::Threads)
otg_add_test(cost_model unit SOURCES test_cost_model.cpp LIBRARIES otg_scenes)
