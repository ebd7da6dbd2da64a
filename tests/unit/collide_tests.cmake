# SPDX-License-Identifier: BSD-3-Clause
otg_add_test(reduce_binning unit SOURCES test_reduce_binning.cpp)
otg_add_test(reduce_cone unit SOURCES test_reduce_cone.cpp)
otg_add_test(limit_contacts unit SOURCES test_limit_contacts.cpp)
otg_add_test(contact_regions unit SOURCES test_contact_regions.cpp)
otg_add_test(triangle_filters unit SOURCES test_triangle_filters.cpp)
otg_add_test(wide_kernels unit SOURCES test_wide_kernels.cpp LIBRARIES otg_scenes)
otg_add_test(surface_kernels unit SOURCES test_surface_kernels.cpp)
otg_add_test(rotation_tolerance unit SOURCES test_rotation_tolerance.cpp LIBRARIES otg_scenes)
otg_add_test(convex_contacts unit SOURCES test_convex_contacts.cpp LIBRARIES otg_scenes otg_primitives)
otg_add_test(contact_ids unit SOURCES test_contact_ids.cpp LIBRARIES otg_scenes)
otg_add_test(solid_regions unit SOURCES test_solid_regions.cpp LIBRARIES otg_scenes)
otg_add_test(small_regions unit SOURCES test_small_regions.cpp LIBRARIES otg_scenes)
otg_add_test(solid_sheet unit SOURCES test_solid_sheet.cpp LIBRARIES otg_scenes)
otg_add_test(shell_contacts unit SOURCES test_shell_contacts.cpp $<TARGET_OBJECTS:otg_test_ode_world> LIBRARIES otg_scenes)
otg_add_test(ray_cast unit SOURCES test_ray_cast.cpp LIBRARIES otg_scenes otg_queries)
otg_add_test(mesh_distance unit SOURCES test_mesh_distance.cpp LIBRARIES otg_scenes otg_queries)

# No file that is compiled for a newer instruction set leaves functions that the linker could choose for all.
if(CMAKE_EXECUTABLE_FORMAT STREQUAL "ELF" AND CMAKE_NM)
  set(simd_symbols "${CMAKE_CURRENT_SOURCE_DIR}/simd_symbols.sh")
  add_test(NAME unit.simd_symbols COMMAND bash "${simd_symbols}" "${CMAKE_NM}" "$<TARGET_OBJECTS:otg_collide>"
           COMMAND_EXPAND_LISTS)
  add_library(otg_simd_leak OBJECT wide_kernels_leak.cpp)
  add_dependencies(tests_unit otg_simd_leak)
  add_test(NAME unit.simd_symbols_self_test
           COMMAND bash "${simd_symbols}" --expect leaked "${CMAKE_NM}" "$<TARGET_OBJECTS:otg_simd_leak>")
  set_tests_properties(unit.simd_symbols unit.simd_symbols_self_test PROPERTIES LABELS unit)
endif()
