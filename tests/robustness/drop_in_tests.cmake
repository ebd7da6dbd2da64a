# SPDX-License-Identifier: BSD-3-Clause
# The preloadable library before programs that are not linked with this project. Not under a sanitizer, whose runtime the
# program would have to bring.
if(TARGET ode_trimesh_gpu_preload AND TARGET demo_drop_in_stack AND NOT OTG_SANITIZE)
  function(otg_add_drop_in_test name)
    add_test(NAME robustness.drop_in_${name}
      COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/test_drop_in.py"
              "$<TARGET_FILE:ode_trimesh_gpu_preload>" ${ARGN})
    set_tests_properties(robustness.drop_in_${name} PROPERTIES LABELS robustness TIMEOUT 600 SKIP_RETURN_CODE 77)
  endfunction()
  otg_add_drop_in_test(stack "$<TARGET_FILE:demo_drop_in_stack>" 5 400)
  otg_add_drop_in_test(quickstep "$<TARGET_FILE:demo_drop_in_stack>" 10 400 2 quick)
  if(TARGET demo_drop_in_dart)
    otg_add_drop_in_test(dart "$<TARGET_FILE:demo_drop_in_dart>" 3 400)
  else()
    add_test(NAME robustness.drop_in_dart COMMAND "${CMAKE_COMMAND}" -E echo
      "skipped: DART with its ODE collision detector is not installed (libdart-collision-ode-dev)")
    set_tests_properties(robustness.drop_in_dart PROPERTIES LABELS robustness SKIP_REGULAR_EXPRESSION "skipped:")
  endif()
  if(TARGET demo_drop_in_gazebo)
    otg_add_drop_in_test(gazebo "$<TARGET_FILE:demo_drop_in_gazebo>" "${OTG_GAZEBO_DART}"
                         "${PROJECT_SOURCE_DIR}/demos/drop_in/gazebo/stack.sdf" 400)
  else()
    add_test(NAME robustness.drop_in_gazebo COMMAND "${CMAKE_COMMAND}" -E echo
      "skipped: Gazebo's physics with DART is not installed (scripts/install_dependencies.sh ci_gazebo)")
    set_tests_properties(robustness.drop_in_gazebo PROPERTIES LABELS robustness SKIP_REGULAR_EXPRESSION "skipped:")
  endif()
  # ODE's own shapes on a dTriMesh, these pairs taken over as well.
  foreach(shape cylinder box)
    add_test(NAME robustness.drop_in_wheel_${shape}
      COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/test_drop_in_wheel.py"
              "$<TARGET_FILE:ode_trimesh_gpu_preload>" "$<TARGET_FILE:demo_drop_in_wheel>" ${shape})
    set_tests_properties(robustness.drop_in_wheel_${shape} PROPERTIES LABELS robustness TIMEOUT 600)
  endforeach()
  # Meshes on a heightfield, that pair taken over as well.
  add_test(NAME robustness.drop_in_hills
    COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/test_drop_in_hills.py"
            "$<TARGET_FILE:ode_trimesh_gpu_preload>" "$<TARGET_FILE:demo_drop_in_hills>")
  set_tests_properties(robustness.drop_in_hills PROPERTIES LABELS robustness TIMEOUT 600)
  # Flat meshes on flat meshes, which ODE's boxes lose sight of.
  add_test(NAME robustness.drop_in_plates
    COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/test_drop_in_plates.py"
            "$<TARGET_FILE:ode_trimesh_gpu_preload>" "$<TARGET_FILE:demo_drop_in_plates>")
  set_tests_properties(robustness.drop_in_plates PROPERTIES LABELS robustness TIMEOUT 600)
  # A road of slabs, which are joined.
  add_test(NAME robustness.drop_in_road
    COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/test_drop_in_road.py"
            "$<TARGET_FILE:ode_trimesh_gpu_preload>" "$<TARGET_FILE:demo_drop_in_road>")
  set_tests_properties(robustness.drop_in_road PROPERTIES LABELS robustness TIMEOUT 600)
  # What ODE crashes with or aborts at.
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(ODE REQUIRED IMPORTED_TARGET ode>=0.16)
  add_executable(test_hostile_trimesh hostile_trimesh.c)
  target_link_libraries(test_hostile_trimesh PRIVATE PkgConfig::ODE otg_flags)
  add_test(NAME robustness.hostile_trimesh COMMAND test_hostile_trimesh)
  add_test(NAME robustness.hostile_trimesh_all COMMAND test_hostile_trimesh)
  set_tests_properties(robustness.hostile_trimesh robustness.hostile_trimesh_all PROPERTIES LABELS robustness TIMEOUT 120
    PASS_REGULAR_EXPRESSION "all answered" FAIL_REGULAR_EXPRESSION "not all answered")
  set_property(TEST robustness.hostile_trimesh PROPERTY
    ENVIRONMENT "LD_PRELOAD=$<TARGET_FILE:ode_trimesh_gpu_preload>")
  set_property(TEST robustness.hostile_trimesh_all PROPERTY
    ENVIRONMENT "LD_PRELOAD=$<TARGET_FILE:ode_trimesh_gpu_preload>;OTG_PRELOAD_PRIMITIVES=all")
  # Environment variables, there and in a program of ours.
  if(TARGET otg)
    add_test(NAME robustness.environment
      COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/test_environment.py"
              "$<TARGET_FILE:otg>" "$<TARGET_FILE:ode_trimesh_gpu_preload>" "$<TARGET_FILE:demo_drop_in_stack>")
    set_tests_properties(robustness.environment PROPERTIES LABELS robustness TIMEOUT 600)
  endif()
  # Debian's own interpreter, which Debian's module is for.
  otg_add_drop_in_test(pyode /usr/bin/python3 "${PROJECT_SOURCE_DIR}/demos/drop_in/pyode_stack.py" 5 400)
endif()
