# SPDX-License-Identifier: BSD-3-Clause
# Who may link whom: harness <- benchmarks, harness <- demos, and tests on top. The library links none of them. What a target
# does not link it cannot include either, because each folder's headers are reached through its targets.

# otg_targets_below(RESULT FOLDER): all targets made in FOLDER of the sources and in folders below it.
function(otg_targets_below result folder)
  get_property(targets DIRECTORY "${folder}" PROPERTY BUILDSYSTEM_TARGETS)
  get_property(inner DIRECTORY "${folder}" PROPERTY SUBDIRECTORIES)
  foreach(below IN LISTS inner)
    otg_targets_below(more "${below}")
    list(APPEND targets ${more})
  endforeach()
  set(${result} ${targets} PARENT_SCOPE)
endfunction()

# otg_check_direction(LOWER UPPER...): stops with an error where a target of the folder LOWER links one of an UPPER folder.
function(otg_check_direction lower)
  get_property(configured DIRECTORY "${PROJECT_SOURCE_DIR}" PROPERTY SUBDIRECTORIES)
  if(NOT "${PROJECT_SOURCE_DIR}/${lower}" IN_LIST configured)
    return()
  endif()
  otg_targets_below(targets "${PROJECT_SOURCE_DIR}/${lower}")
  foreach(upper IN LISTS ARGN)
    if(NOT "${PROJECT_SOURCE_DIR}/${upper}" IN_LIST configured)
      continue()
    endif()
    otg_targets_below(forbidden "${PROJECT_SOURCE_DIR}/${upper}")
    foreach(target IN LISTS targets)
      get_target_property(linked ${target} LINK_LIBRARIES)
      get_target_property(passed_on ${target} INTERFACE_LINK_LIBRARIES)
      string(REGEX MATCHALL "[A-Za-z0-9_]+" libraries "${linked};${passed_on}")  # inside generator expressions, too
      foreach(library IN LISTS libraries)
        if(library IN_LIST forbidden)
          message(FATAL_ERROR "${target} of ${lower}/ links ${library} of ${upper}/: that is the wrong direction.")
        endif()
      endforeach()
    endforeach()
  endforeach()
endfunction()
