# SPDX-License-Identifier: BSD-3-Clause
# The C API and the geom class.
add_library(otg_test_ode_world OBJECT "${OTG_TEST_DIR}/support/ode_world.cpp" "${OTG_TEST_DIR}/support/pile_world.cpp")
target_include_directories(otg_test_ode_world PUBLIC "${OTG_TEST_DIR}")
target_link_libraries(otg_test_ode_world PUBLIC otg_scenes PRIVATE otg_catch otg_flags)

find_package(Threads REQUIRED)
foreach(name warm pair_limit nested roles self_touching shells misuse init data geom collide contact_data history threads memory batch prefetch prefetch_shapes still_shapes still_pairs
             pair_memory override parity queries
             primitives convex convex_mesh convex_cylinder rims behind_sheets inward memory_ways join shapes mirrored kink heightfield primitive_callbacks override_primitives
             override_batch)
  otg_add_test(ode_${name} unit
    SOURCES test_ode_${name}.cpp $<TARGET_OBJECTS:otg_test_ode_world> LIBRARIES otg_scenes Threads::Threads)
endforeach()

target_link_libraries(test_ode_convex PRIVATE otg_truth)
target_link_libraries(test_ode_convex_mesh PRIVATE otg_truth)
target_link_libraries(test_ode_convex_cylinder PRIVATE otg_truth)
target_link_libraries(test_ode_shapes PRIVATE otg_truth)

# Every public header alone, as C89 and as C++, twice in a row. ODE's own headers, which have // comments, are system
# headers to the compiler and exempt.
set(include_dir "${PROJECT_SOURCE_DIR}/ode_trimesh_gpu/include")
file(GLOB headers RELATIVE "${include_dir}" CONFIGURE_DEPENDS "${include_dir}/ode_trimesh_gpu/*.h"
     "${include_dir}/ode_trimesh_gpu/*.hpp")
set(c_sources "")
set(cxx_sources "")
foreach(header IN LISTS headers)
  string(MAKE_C_IDENTIFIER "${header}" stem)
  set(content "#include \"${header}\"\n#include \"${header}\"\nextern int otg_header_${stem};\nint otg_header_${stem} = 0;\n")
  file(CONFIGURE OUTPUT "headers/${stem}.cpp" CONTENT "${content}" @ONLY)
  list(APPEND cxx_sources "${CMAKE_CURRENT_BINARY_DIR}/headers/${stem}.cpp")
  if(header MATCHES "\\.h$")
    file(CONFIGURE OUTPUT "headers/${stem}.c" CONTENT "${content}" @ONLY)
    list(APPEND c_sources "${CMAKE_CURRENT_BINARY_DIR}/headers/${stem}.c")
  endif()
endforeach()
add_library(otg_headers_c89 OBJECT ${c_sources})
add_library(otg_headers_cxx OBJECT ${cxx_sources})
set_target_properties(otg_headers_c89 PROPERTIES C_STANDARD 90 C_EXTENSIONS OFF)
set_target_properties(otg_headers_cxx PROPERTIES CXX_STANDARD 11)
foreach(target otg_headers_c89 otg_headers_cxx)
  target_link_libraries(${target} PRIVATE ode_trimesh_gpu otg_flags)
  target_compile_options(${target} PRIVATE -pedantic-errors)
endforeach()

add_executable(test_ode_c89 header_c89.c)
set_target_properties(test_ode_c89 PROPERTIES C_STANDARD 90 C_EXTENSIONS OFF)
target_compile_options(test_ode_c89 PRIVATE -pedantic-errors)
target_link_libraries(test_ode_c89 PRIVATE ode_trimesh_gpu otg_flags)
if(OTG_SANITIZE)  # the library needs the part of the runtime that Clang links into C++ programs alone
  set_target_properties(test_ode_c89 PROPERTIES LINKER_LANGUAGE CXX)
endif()
add_dependencies(tests_unit test_ode_c89)
add_test(NAME unit.ode_c89 COMMAND test_ode_c89)

if(CMAKE_EXECUTABLE_FORMAT STREQUAL "ELF" AND CMAKE_NM)
  add_test(NAME unit.ode_exported_symbols COMMAND bash "${CMAKE_CURRENT_SOURCE_DIR}/exported_symbols.sh" "${CMAKE_NM}"
           "$<TARGET_FILE:ode_trimesh_gpu>" "${include_dir}" "$<TARGET_PROPERTY:ode_trimesh_gpu,SOVERSION>")
  set_tests_properties(unit.ode_exported_symbols PROPERTIES LABELS unit)
endif()
set_tests_properties(unit.ode_c89 PROPERTIES LABELS unit)
otg_add_test(geom_table unit SOURCES test_geom_table.cpp)
otg_add_test(cooked_mesh unit
  SOURCES test_cooked_mesh.cpp $<TARGET_OBJECTS:otg_test_ode_world> LIBRARIES otg_scenes)
otg_add_test(cooked_mutations unit
  SOURCES test_cooked_mutations.cpp $<TARGET_OBJECTS:otg_test_ode_world> LIBRARIES otg_scenes)
# ThreadSanitizer ends a child that makes threads. AddressSanitizer of Clang 14 does not free its allocator's locks in a child.
if(NOT OTG_SANITIZE)
  otg_add_test(fork unit SOURCES test_fork.cpp $<TARGET_OBJECTS:otg_test_ode_world> LIBRARIES otg_scenes Threads::Threads)
  add_library(otg_slow_driver MODULE slow_driver.cpp)
  target_link_libraries(otg_slow_driver PRIVATE otg_flags)
  set_target_properties(otg_slow_driver PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
  otg_add_test(fork_while_loading unit SOURCES test_fork_while_loading.cpp LIBRARIES Threads::Threads)
  # The driver looks for two names of the test.
  set_target_properties(test_fork_while_loading PROPERTIES ENABLE_EXPORTS ON CXX_VISIBILITY_PRESET default)
  target_compile_definitions(test_fork_while_loading PRIVATE "OTG_SLOW_DRIVER=\"$<TARGET_FILE:otg_slow_driver>\"")
  add_dependencies(test_fork_while_loading otg_slow_driver)
endif()
otg_add_test(partial_update unit
  SOURCES test_partial_update.cpp $<TARGET_OBJECTS:otg_test_ode_world> LIBRARIES otg_scenes)
