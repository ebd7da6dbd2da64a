# SPDX-License-Identifier: BSD-3-Clause
# The oracle of `otg bench contacts`; what the demo is made of, where it is built.
otg_add_test(overlap_volume unit SOURCES test_overlap_volume.cpp LIBRARIES otg_truth)
otg_add_test(tessellations unit SOURCES test_tessellations.cpp LIBRARIES otg_truth)
if(TARGET otg_simulation)
  otg_add_test(povray_scene unit SOURCES test_povray_scene.cpp LIBRARIES otg_simulation)
endif()
if(TARGET otg_progress)
  otg_add_test(progress unit SOURCES test_progress.cpp LIBRARIES otg_progress)
endif()
