# SPDX-License-Identifier: BSD-3-Clause
otg_add_test(bvh_build unit SOURCES test_bvh_build.cpp LIBRARIES otg_scenes)
otg_add_test(bvh_boxes unit SOURCES test_bvh_boxes.cpp LIBRARIES otg_scenes)
otg_add_test(bvh_validator unit SOURCES test_bvh_validator.cpp LIBRARIES otg_scenes)
otg_add_test(bvh_packed unit SOURCES test_bvh_packed.cpp LIBRARIES otg_scenes)
otg_add_test(bvh_refit unit SOURCES test_bvh_refit.cpp LIBRARIES otg_scenes)
otg_add_test(scaled_meshes unit SOURCES test_scaled_meshes.cpp LIBRARIES otg_scenes)
find_package(Threads REQUIRED)
otg_add_test(bvh_threads unit SOURCES test_bvh_threads.cpp LIBRARIES otg_scenes Threads::Threads)
