# SPDX-License-Identifier: BSD-3-Clause
# The layers of the library: mesh <- bvh <- collide <- opencl <- dispatch, and ode on top.
#
# otg_add_layer(NAME SOURCES ... DEPENDS ...) makes the object library otg_NAME from ode_trimesh_gpu/NAME. Its headers are
# reached as "NAME/header.h" through a link in the build tree that only targets which link otg_NAME get to see, so an
# include against the direction of the layers does not compile.
function(otg_add_layer name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  set(root "${PROJECT_BINARY_DIR}/layers/${name}")
  file(MAKE_DIRECTORY "${root}")
  file(CREATE_LINK "${PROJECT_SOURCE_DIR}/ode_trimesh_gpu/${name}" "${root}/${name}" SYMBOLIC)
  add_library(otg_${name} OBJECT ${ARG_SOURCES})
  target_include_directories(otg_${name} PUBLIC "${root}")
  target_link_libraries(otg_${name} PUBLIC ${ARG_DEPENDS} PRIVATE otg_flags)
  set_property(GLOBAL APPEND PROPERTY OTG_LAYERS otg_${name})
endfunction()
