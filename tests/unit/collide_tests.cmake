# SPDX-License-Identifier: BSD-3-Clause
otg_add_test(reduce_binning unit SOURCES test_reduce_binning.cpp)
otg_add_test(reduce_cone unit SOURCES test_reduce_cone.cpp)
otg_add_test(limit_contacts unit SOURCES test_limit_contacts.cpp)
otg_add_test(contact_regions unit SOURCES test_contact_regions.cpp)
otg_add_test(triangle_filters unit SOURCES test_triangle_filters.cpp)
otg_add_test(wide_kernels unit SOURCES test_wide_kernels.cpp LIBRARIES otg_scenes)
otg_add_test(rotation_tolerance unit SOURCES test_rotation_tolerance.cpp LIBRARIES otg_scenes)
otg_add_test(solid_regions unit SOURCES test_solid_regions.cpp LIBRARIES otg_scenes)
