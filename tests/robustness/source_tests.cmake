# SPDX-License-Identifier: BSD-3-Clause
# Tests of the sources themselves: the rules of the layers, no cycles of includes, and that the shared headers are OpenCL C as well.
add_test(NAME robustness.layer_rules
         COMMAND bash "${CMAKE_CURRENT_SOURCE_DIR}/layer_rules.sh" "${PROJECT_SOURCE_DIR}")
add_test(NAME robustness.layer_rules_self_test
         COMMAND bash "${CMAKE_CURRENT_SOURCE_DIR}/layer_rules.sh" --self-test "${CMAKE_CURRENT_BINARY_DIR}/layer_rules")
set_tests_properties(robustness.layer_rules robustness.layer_rules_self_test PROPERTIES LABELS robustness TIMEOUT 120)

# That no sources need each other, inside layers as between them.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_test(NAME robustness.include_cycles
         COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/include_cycles.py" "${PROJECT_SOURCE_DIR}")
add_test(NAME robustness.include_cycles_self_test
         COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/include_cycles.py" --self-test
                 "${CMAKE_CURRENT_BINARY_DIR}/include_cycles")
set_tests_properties(robustness.include_cycles robustness.include_cycles_self_test PROPERTIES LABELS robustness TIMEOUT 60)
# That kernels are short and take few things.
add_test(NAME robustness.kernel_rules
         COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/kernel_rules.py" "${PROJECT_SOURCE_DIR}"
                 "${CMAKE_CURRENT_SOURCE_DIR}/kernel_exceptions.txt")
add_test(NAME robustness.kernel_rules_self_test
         COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/kernel_rules.py"
                 --self-test "${CMAKE_CURRENT_BINARY_DIR}/kernel_rules")
set_tests_properties(robustness.kernel_rules robustness.kernel_rules_self_test PROPERTIES LABELS robustness TIMEOUT 60)

# Not only that there is a docstring: a function that gains an argument has to say what it is.
add_test(NAME robustness.docstrings
         COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/test_docstrings.py"
                 "${PROJECT_SOURCE_DIR}/ode_trimesh_gpu/include/ode_trimesh_gpu")
set_tests_properties(robustness.docstrings PROPERTIES LABELS robustness TIMEOUT 60)

add_test(NAME robustness.documents
         COMMAND "${Python3_EXECUTABLE}" -B "${CMAKE_CURRENT_SOURCE_DIR}/test_documents.py")
set_tests_properties(robustness.documents PROPERTIES LABELS robustness TIMEOUT 60)

# Under a sanitizer the OpenCL compiler inside the driver is what would be examined, so not there.
find_package(OpenCL)
if(OpenCL_FOUND AND NOT OTG_SANITIZE)
  add_executable(test_shared_headers_opencl shared_headers_opencl.cpp)
  target_compile_definitions(test_shared_headers_opencl PRIVATE OTG_KERNEL_DIR="${PROJECT_SOURCE_DIR}/kernels")
  target_link_libraries(test_shared_headers_opencl PRIVATE OpenCL::OpenCL otg_flags)
  add_test(NAME robustness.shared_headers_opencl COMMAND test_shared_headers_opencl)
  set_tests_properties(robustness.shared_headers_opencl PROPERTIES
    LABELS robustness TIMEOUT 600 SKIP_RETURN_CODE 77)
elseif(NOT OpenCL_FOUND)
  message(STATUS "OpenCL not found: robustness.shared_headers_opencl is left out (Debian: ocl-icd-opencl-dev)")
endif()
