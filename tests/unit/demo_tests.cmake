# SPDX-License-Identifier: BSD-3-Clause
# What the demo is made of, where it is built.
if(OTG_BUILD_DEMOS)
  otg_add_test(povray_scene unit SOURCES test_povray_scene.cpp LIBRARIES otg_simulation)
endif()
