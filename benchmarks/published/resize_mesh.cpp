// SPDX-License-Identifier: BSD-3-Clause
// A closed mesh with another number of triangles: CGAL subdivides it (Loop) until it has more, then takes edges away
// (Lindstrom and Turk) until it has as many. resize_mesh IN.off OUT.ply TRIANGLES
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/boost/graph/IO/polygon_mesh_io.h>
#include <CGAL/subdivision_method_3.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

using Mesh = CGAL::Surface_mesh<CGAL::Simple_cartesian<double>::Point_3>;

// NOLINTNEXTLINE(bugprone-exception-escape): ends with the exception's message
int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: resize_mesh IN.off OUT.ply TRIANGLES\n"), 2;
  const std::size_t wanted = std::strtoul(argv[3], nullptr, 10);
  Mesh mesh;
  if (!CGAL::IO::read_polygon_mesh(argv[1], mesh) || !CGAL::is_closed(mesh) || wanted < 4 || wanted % 2 != 0) {
    return std::fprintf(stderr, "%s: no closed mesh, or not an even number of triangles\n", argv[1]), 1;
  }
  while (mesh.number_of_faces() < wanted) {
    CGAL::Subdivision_method_3::Loop_subdivision(mesh, CGAL::parameters::number_of_iterations(1));
  }
  namespace sms = CGAL::Surface_mesh_simplification;
  sms::edge_collapse(mesh, sms::Count_stop_predicate<Mesh>(wanted / 2 * 3 + 1));
  mesh.collect_garbage();
  if (mesh.number_of_faces() != wanted) {
    return std::fprintf(stderr, "%s: %zu triangles instead of %zu\n", argv[1], std::size_t(mesh.number_of_faces()),
                        wanted),
           1;
  }
  std::ofstream out(argv[2], std::ios::binary);
  CGAL::IO::set_binary_mode(out);
  return CGAL::IO::write_PLY(out, mesh) && out.flush() ? 0 : 1;
}
