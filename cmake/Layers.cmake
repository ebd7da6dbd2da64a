# SPDX-License-Identifier: BSD-3-Clause
# The layers of the library: base <- mesh <- bvh <- collide <- opencl <- dispatch, and ode on top.
#
# otg_add_layer(NAME SOURCES ... DEPENDS ...) makes the object library otg_NAME from ode_trimesh_gpu/NAME and its folders; a
# layer of headers alone is an interface library. Its headers are reached as "NAME/header.h" or "NAME/folder/header.h"
# through a link in the build tree that only targets which link otg_NAME get to see, so an include against the direction
# of the layers does not compile.
#
# TOGETHER compiles sources in groups: half of a file's time is what it includes. Names in unnamed namespaces then have to
# differ within the layer; a file for which they do not, or that has compiler options, stays alone.
# CMAKE_UNITY_BUILD=OFF takes all of them apart.
function(otg_add_layer name)
  cmake_parse_arguments(ARG "TOGETHER" "" "SOURCES;DEPENDS" ${ARGN})
  set(root "${PROJECT_BINARY_DIR}/layers/${name}")
  file(MAKE_DIRECTORY "${root}")
  file(CREATE_LINK "${PROJECT_SOURCE_DIR}/ode_trimesh_gpu/${name}" "${root}/${name}" SYMBOLIC)
  if(ARG_SOURCES)
    add_library(otg_${name} OBJECT ${ARG_SOURCES})
    target_include_directories(otg_${name} PUBLIC "${root}")
    target_link_libraries(otg_${name} PUBLIC ${ARG_DEPENDS} PRIVATE otg_flags)
    if(ARG_TOGETHER AND NOT DEFINED CMAKE_UNITY_BUILD)
      set_target_properties(otg_${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
    endif()
    set_property(GLOBAL APPEND PROPERTY OTG_LAYER_OBJECTS "$<TARGET_OBJECTS:otg_${name}>")
  else()
    add_library(otg_${name} INTERFACE)
    target_include_directories(otg_${name} INTERFACE "${root}")
    target_link_libraries(otg_${name} INTERFACE ${ARG_DEPENDS})
  endif()
  set_property(GLOBAL APPEND PROPERTY OTG_LAYERS otg_${name})
endfunction()
