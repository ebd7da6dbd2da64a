# SPDX-License-Identifier: BSD-3-Clause
# Debian packages of the components by CPack: `cpack` in the build folder, or scripts/packages.sh, which checks them as well.
# Debian wants a copyright file and a changelog in each; OTG_DEBIAN_PACKAGES adds them to what is installed.
set(OTG_PACKAGE_MAINTAINER "ode_trimesh_gpu authors <maintainers@ode-trimesh-gpu.invalid>" CACHE STRING "Maintainer of the Debian packages.")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME ode-trimesh-gpu)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGE_CONTACT "${OTG_PACKAGE_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL library development tools preload documentation)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

get_target_property(soversion ode_trimesh_gpu SOVERSION)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libode-trimesh-gpu${soversion})
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libode-trimesh-gpu-dev)
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME ode-trimesh-gpu-tools)
set(CPACK_DEBIAN_PRELOAD_PACKAGE_NAME libode-trimesh-gpu-preload)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_NAME libode-trimesh-gpu-doc)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${CPACK_DEBIAN_LIBRARY_PACKAGE_NAME} (= ${PROJECT_VERSION}-1), libode-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS g++)  # links the archive
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SUGGESTS ocl-icd-libopencl1)

# CPack takes one synopsis for all.
set(about "A triangle-mesh geom class for ODE. The sets of intersecting triangles are\nexact, and contacts are those of bodies and not of triangles, on the CPU and\non OpenCL devices.")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "${about}\n\nThis package has the shared library.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "${about}\n\nThis package has headers, the archive, and files for CMake and pkg-config.")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "${about}\n\nThis package has the program otg, which checks meshes, collides them and\nsteps scenes.")
set(CPACK_COMPONENT_PRELOAD_DESCRIPTION "${about}\n\nThis package has a library to preload into programs that use dTriMesh.")
set(CPACK_COMPONENT_DOCUMENTATION_DESCRIPTION "${about}\n\nThis package has the manual and examples.")

# Debian has the cache of the loader renewed by a trigger.
set(triggers "${CMAKE_CURRENT_BINARY_DIR}/triggers")
file(WRITE "${triggers}" "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA "${triggers}")
set(CPACK_DEBIAN_PRELOAD_PACKAGE_CONTROL_EXTRA "${triggers}")

if(OTG_DEBIAN_PACKAGES)
  # The changelog of packages has one entry: the version that they are built of.
  string(TIMESTAMP today "%a, %d %b %Y %H:%M:%S +0000" UTC)
  set(changelog "${CMAKE_CURRENT_BINARY_DIR}/changelog.Debian")
  file(WRITE "${changelog}" "ode-trimesh-gpu (${PROJECT_VERSION}-1) unstable; urgency=medium\n\n  * See CHANGELOG.md.\n\n -- ${OTG_PACKAGE_MAINTAINER}  ${today}\n")
  execute_process(COMMAND gzip -9nf "${changelog}" COMMAND_ERROR_IS_FATAL ANY)
  foreach(component IN LISTS CPACK_COMPONENTS_ALL)
    string(TOUPPER "${component}" upper)
    set(folder "${CMAKE_INSTALL_DATAROOTDIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME}")
    install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${folder}" RENAME copyright COMPONENT ${component})
    install(FILES "${changelog}.gz" DESTINATION "${folder}" COMPONENT ${component})
  endforeach()
endif()
include(CPack)
