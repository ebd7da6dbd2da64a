# SPDX-License-Identifier: BSD-3-Clause
# The program otg as its users meet it, and the mesh readers behind it.
if(TARGET otg)
  set(subjects check hostile collide pairs batch simulate html heightfield hand_over soak)
  if(TARGET otg_bench)
    list(APPEND subjects bench)
  endif()
  foreach(subject IN LISTS subjects)
    add_test(NAME robustness.cli_${subject}
      COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/test_cli_${subject}.py" "$<TARGET_FILE:otg>")
    set_tests_properties(robustness.cli_${subject} PROPERTIES LABELS robustness TIMEOUT 600 SKIP_RETURN_CODE 77)
  endforeach()
  if(TARGET otg_bench)
    add_test(NAME robustness.results
      COMMAND "${Python3_EXECUTABLE}" -B "${PROJECT_SOURCE_DIR}/scripts/results.py" "$<TARGET_FILE:otg>"
              "${PROJECT_SOURCE_DIR}/docs/results" --check)
    set_tests_properties(robustness.results PROPERTIES LABELS robustness TIMEOUT 600)
    add_test(NAME robustness.documented_commands
      COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/test_documented_commands.py" "$<TARGET_FILE:otg>")
    set_tests_properties(robustness.documented_commands PROPERTIES LABELS robustness)
  endif()
  otg_add_test(mesh_files robustness SOURCES test_mesh_files.cpp LIBRARIES otg_mesh_io)
endif()

# The demo programs, with little to do.
if(TARGET demo_prefetch)
  add_test(NAME robustness.demo_prefetch COMMAND demo_prefetch 30 40)
  add_test(NAME robustness.demo_prefetch_shapes COMMAND demo_prefetch 60 40 shapes)
  set_tests_properties(robustness.demo_prefetch robustness.demo_prefetch_shapes PROPERTIES LABELS robustness)
endif()

# The page of `otg simulate --html` as a browser shows it; skipped without Chromium, which no other test needs.
if(TARGET otg)
  add_test(NAME robustness.viewer
    COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/viewer/test_viewer.py" "$<TARGET_FILE:otg>")
  set_tests_properties(robustness.viewer PROPERTIES LABELS robustness TIMEOUT 900 SKIP_RETURN_CODE 77)
endif()
