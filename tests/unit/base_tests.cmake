# SPDX-License-Identifier: BSD-3-Clause
find_package(Threads REQUIRED)
otg_add_test(base unit SOURCES test_base.cpp LIBRARIES Threads::Threads)
otg_add_test(environment unit SOURCES test_environment.cpp)

# A program that stays while the library goes has the library of POSIX threads as a DLL: in an archive it would go, too.
if(MINGW)
  add_executable(test_unload unload_windows.c)
  add_dependencies(test_unload ode_trimesh_gpu)
  target_link_libraries(test_unload PRIVATE otg_flags -Wl,-Bdynamic winpthread)
  set(folders)
  foreach(dll libstdc++-6.dll libwinpthread-1.dll)
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=${dll} OUTPUT_VARIABLE path OUTPUT_STRIP_TRAILING_WHITESPACE)
    get_filename_component(path "${path}" REALPATH)
    get_filename_component(path "${path}" DIRECTORY)
    list(APPEND folders "Z:${path}")
  endforeach()
  list(JOIN folders "\\;" folders)  # one value with semicolons in it
  add_test(NAME unit.unload COMMAND test_unload "$<TARGET_FILE:ode_trimesh_gpu>")
  set_tests_properties(unit.unload PROPERTIES LABELS unit TIMEOUT 120 ENVIRONMENT "WINEPATH=${folders}")
endif()
