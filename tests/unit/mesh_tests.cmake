# SPDX-License-Identifier: BSD-3-Clause
otg_add_test(mesh_generated unit SOURCES test_mesh_generated.cpp LIBRARIES otg_scenes)
