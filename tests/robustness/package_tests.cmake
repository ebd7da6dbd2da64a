# SPDX-License-Identifier: BSD-3-Clause
# The installed tree as a user sees it. Not under a sanitizer, whose runtime the user's program would have to bring.
if(NOT OTG_SANITIZE)
  add_test(NAME robustness.installed_package
    COMMAND bash "${CMAKE_CURRENT_SOURCE_DIR}/installed_package/run.sh" "${CMAKE_COMMAND}" "${PROJECT_BINARY_DIR}"
            "${PROJECT_SOURCE_DIR}" "${CMAKE_CURRENT_BINARY_DIR}/installed_package" "${CMAKE_C_COMPILER}"
            "${CMAKE_CXX_COMPILER}" "${CMAKE_GENERATOR}" "${CMAKE_MAKE_PROGRAM}")
  set_tests_properties(robustness.installed_package PROPERTIES LABELS robustness TIMEOUT 600)
  # Configures only; `run.sh SOURCE SCRATCH --build` belongs before a release.
  if(CMAKE_GENERATOR STREQUAL "Ninja")
    add_test(NAME robustness.subproject
      COMMAND bash "${CMAKE_CURRENT_SOURCE_DIR}/subproject/run.sh" "${PROJECT_SOURCE_DIR}" "${CMAKE_CURRENT_BINARY_DIR}/subproject")
    set_tests_properties(robustness.subproject PROPERTIES LABELS robustness TIMEOUT 600)
  endif()
endif()
