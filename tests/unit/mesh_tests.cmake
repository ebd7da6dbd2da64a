# SPDX-License-Identifier: BSD-3-Clause
otg_add_test(mesh_generated unit SOURCES test_mesh_generated.cpp LIBRARIES otg_scenes)
otg_add_test(mesh unit
  SOURCES test_mesh_topology.cpp test_mesh_validation.cpp test_mesh_repair.cpp test_mesh_input.cpp test_mesh_mass.cpp
  LIBRARIES otg_scenes)
otg_add_test(touching_edges unit SOURCES test_touching_edges.cpp LIBRARIES otg_scenes otg_truth otg_collide)
otg_add_test(outward_sides unit SOURCES test_outward_sides.cpp LIBRARIES otg_scenes otg_truth)
otg_add_test(mesh_order unit SOURCES test_mesh_order.cpp LIBRARIES otg_scenes otg_collide)
otg_add_test(convex_polyhedron unit SOURCES test_convex_polyhedron.cpp LIBRARIES otg_scenes otg_primitives)
