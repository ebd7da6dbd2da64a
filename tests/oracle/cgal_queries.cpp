// SPDX-License-Identifier: BSD-3-Clause
#include "oracle/cgal_queries.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/squared_distance_3.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace otg::test {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using TriangleTree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

Kernel::Point_3 point(const Vec3d& p) {
  return {p.x, p.y, p.z};
}

}  // namespace

struct CgalSurface::Tree {
  Triangles triangles;
  TriangleTree tree;
  Surface surface;
  std::unique_ptr<CGAL::Side_of_triangle_mesh<Surface, Kernel>> side;
};

CgalSurface::CgalSurface(const TriMesh& mesh, const Transformd& pose) : tree_(std::make_unique<Tree>()) {
  std::map<std::uint32_t, Surface::Vertex_index> vertices;
  for (const Triangle& t : mesh.triangles()) {
    Kernel::Point_3 corner[3];
    Surface::Vertex_index index[3];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.topology().weld[t.v[k]];
      const Vec3f& p = mesh.vertices()[v];
      corner[k] = point(otgTransform(pose, Vec3d{p.x, p.y, p.z}));
      const auto [it, isNew] = vertices.try_emplace(v);
      if (isNew) it->second = tree_->surface.add_vertex(corner[k]);
      index[k] = it->second;
    }
    tree_->triangles.emplace_back(corner[0], corner[1], corner[2]);
    if (tree_->surface.add_face(index[0], index[1], index[2]) == Surface::null_face()) {
      throw std::runtime_error("not a manifold");
    }
  }
  tree_->tree.insert(tree_->triangles.cbegin(), tree_->triangles.cend());
  tree_->tree.build();
  tree_->side = std::make_unique<CGAL::Side_of_triangle_mesh<Surface, Kernel>>(tree_->surface);
}

CgalSurface::~CgalSurface() = default;

double CgalSurface::distance(const Vec3d& p) const {
  return std::sqrt(tree_->tree.squared_distance(point(p)));
}

bool CgalSurface::isInside(const Vec3d& p) const {
  return (*tree_->side)(point(p)) == CGAL::ON_BOUNDED_SIDE;
}

std::vector<double> CgalSurface::hits(const Vec3d& origin, const Vec3d& direction) const {
  const Kernel::Ray_3 ray(point(origin), Kernel::Vector_3(direction.x, direction.y, direction.z));
  std::vector<TriangleTree::Intersection_and_primitive_id<Kernel::Ray_3>::Type> found;
  tree_->tree.all_intersections(ray, std::back_inserter(found));
  std::vector<double> out;
  for (const auto& hit : found) {
    const auto* const at = boost::get<Kernel::Point_3>(&hit.first);
    if (at == nullptr) continue;  // along a triangle's plane
    const Kernel::Vector_3 way = *at - point(origin);
    out.push_back((way.x() * direction.x + way.y() * direction.y + way.z() * direction.z) /
                  otgDot(direction, direction));
  }
  std::sort(out.begin(), out.end());
  return out;
}

double CgalSurface::distance(const CgalSurface& other) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Kernel::Triangle_3& s : tree_->triangles) {
    if (other.tree_->tree.do_intersect(s)) return 0;
    for (const Kernel::Triangle_3& t : other.tree_->triangles) least = std::min(least, CGAL::squared_distance(s, t));
  }
  return std::sqrt(least);
}

}  // namespace otg::test
