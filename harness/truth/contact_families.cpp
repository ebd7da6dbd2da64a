// SPDX-License-Identifier: BSD-3-Clause
#include "truth/contact_families.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vectors.h"
#include "collide/query.h"
#include "scenes/generated_meshes.h"

namespace otg::truth {
namespace {

constexpr double kPi = std::numbers::pi;
const Transformd kIdentity{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

std::shared_ptr<const CollisionMesh> meshOf(const scenes::MeshArrays& arrays) {
  return std::make_shared<CollisionMesh>(scenes::build(arrays), BuildStrategy::kSah);
}

Transformd about(const Vec3d& u, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), k = 1 - c;
  return {
      {c + k * u.x * u.x, k * u.x * u.y - s * u.z, k * u.x * u.z + s * u.y, k * u.x * u.y + s * u.z, c + k * u.y * u.y,
       k * u.y * u.z - s * u.x, k * u.x * u.z - s * u.y, k * u.y * u.z + s * u.x, c + k * u.z * u.z},
      {0, 0, 0}};
}

/// The transform that applies `inner` first.
Transformd product(const Transformd& outer, const Transformd& inner) {
  Transformd out{};
  for (int k = 0; k < 3; ++k) {
    const Vec3d column = otgRotate(outer, Vec3d{inner.r[k], inner.r[3 + k], inner.r[6 + k]});
    out.r[k] = column.x;
    out.r[3 + k] = column.y;
    out.r[6 + k] = column.z;
  }
  out.t = otgTransform(outer, inner.t);
  return out;
}

Transformd moved(Transformd pose, const Vec3d& by) {
  pose.t = pose.t + by;
  return pose;
}

bool touch(const ContactFamily& family, const Transformd& pose, Workspace& workspace) {
  Query query;
  query.a = family.a.get();
  query.b = family.b.get();
  query.bInA = pose;
  findIntersectingPairs(query, workspace);
  return !workspace.intersecting.empty();
}

/// From far away along `direction` to where the meshes first touch, and from there `overlap` (a length) further.
Transformd pushedTogether(const ContactFamily& family, const Transformd& turn, const Vec3d& direction, double overlap) {
  Workspace workspace;
  const double far = static_cast<double>(family.a->mesh().radius() + family.b->mesh().radius());
  double outside = far, inside = 0;
  constexpr int kSteps = 48;
  for (int i = 1; i <= kSteps; ++i) {
    inside = far * (1 - static_cast<double>(i) / kSteps);
    if (touch(family, moved(turn, direction * inside), workspace)) break;
    outside = inside;
  }
  while (outside - inside > 1e-6 * family.size) {
    const double middle = 0.5 * (inside + outside);
    (touch(family, moved(turn, direction * middle), workspace) ? inside : outside) = middle;
  }
  return moved(turn, direction * (outside - overlap));
}

/// How far A must go along `direction` until the triangles no longer meet, near a guess: for bodies that are not
/// convex.
double exitDepth(const ContactFamily& family, const Transformd& pose, const Vec3d& direction, double guess) {
  Workspace workspace;
  const auto meet = [&](double s) { return touch(family, moved(pose, direction * -s), workspace); };
  double inside = 0.5 * guess, outside = guess + 0.05 * family.size;
  while (outside - inside > 1e-7 * family.size) {
    const double middle = 0.5 * (inside + outside);
    (meet(middle) ? inside : outside) = middle;
  }
  return outside;
}

Separation convexTruth(const ContactFamily& family, const Transformd& pose, const Vec3d& direction) {
  return {direction, extentDepth(family.a->mesh(), family.b->mesh(), pose, direction)};
}

ContactFamily spheres() {
  ContactFamily f;
  f.name = "spheres";
  f.what = "two spheres of 5,120 triangles";
  f.a = f.b = meshOf(scenes::makeSphere(1, 4));
  f.place = [f](Random& random, double overlap) {
    const Vec3d d = random.direction();
    Placement p;
    p.bInA = moved(random.rotation(), d * (2 - overlap));
    p.truth = convexTruth(f, p.bInA, d * -1.0);
    return p;
  };
  return f;
}

constexpr Vec3d kBoxA{1, 0.8, 0.6}, kBoxB{0.5, 0.5, 0.5};

ContactFamily boxes(const std::string& name, const std::string& what) {
  ContactFamily f;
  f.name = name;
  f.what = what;
  f.a = meshOf(scenes::makeBox(kBoxA * 2.0, 2));
  f.b = meshOf(scenes::makeBox(kBoxB * 2.0, 2));
  f.size = 0.5;
  return f;
}

/// B on one of A's faces, shifted so far that edges may hang over.
ContactFamily boxesOnFaces(bool turned) {
  ContactFamily f = turned ? boxes("boxes_face_turned", "a box on a face of another, turned about the normal")
                           : boxes("boxes_aligned", "a box on a face of another, edges parallel");
  f.place = [turned, size = f.size](Random& random, double overlap) {
    const double a[3] = {kBoxA.x, kBoxA.y, kBoxA.z};
    const int k = random.below(3);
    const double side = random.sign();
    double t[3];
    for (int i = 0; i < 3; ++i) t[i] = random.uniform(-0.9, 0.9) * a[i];
    t[k] = side * (a[k] + 0.5 - overlap * size);
    const Vec3d axis{k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
    Placement p;
    p.bInA = moved(turned ? about(axis, random.uniform(0, kPi)) : kIdentity, {t[0], t[1], t[2]});
    p.truth = boxBox(kBoxA, kBoxB, p.bInA);
    return p;
  };
  return f;
}

ContactFamily boxesTurned() {
  ContactFamily f = boxes("boxes_turned", "two boxes turned at random");
  f.place = [f](Random& random, double overlap) {
    const Vec3d d = random.direction();
    Placement p;
    p.bInA = pushedTogether(f, random.rotation(), d, overlap * f.size);
    p.truth = boxBox(kBoxA, kBoxB, p.bInA);
    return p;
  };
  return f;
}

/// A ball at a chosen distance from a convex body, in a random direction from the body's middle.
ContactFamily ballOn(const std::string& name, const std::string& what, const scenes::MeshArrays& body,
                     std::function<Distance(const Vec3d&)> distance) {
  ContactFamily f;
  f.name = name;
  f.what = what;
  f.a = meshOf(body);
  f.b = meshOf(scenes::makeSphere(0.5, 4));
  f.size = 0.5;
  f.place = [f, distance = std::move(distance)](Random& random, double overlap) {
    const Vec3d d = random.direction();
    const double wanted = 0.5 - overlap * f.size;
    double near = 0, far = 4;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (near + far);
      (distance(d * middle).value < wanted ? near : far) = middle;
    }
    Placement p;
    p.bInA = moved(random.rotation(), d * far);
    p.truth = convexTruth(f, p.bInA, distance(p.bInA.t).outward * -1.0);
    return p;
  };
  return f;
}

ContactFamily ballOnTorus() {
  ContactFamily f;
  f.name = "ball_torus";
  f.what = "a ball on a torus, from all sides";
  f.a = meshOf(scenes::makeTorus(1, 0.4, 96, 48));
  f.b = meshOf(scenes::makeSphere(0.3, 4));
  f.size = 0.3;
  f.place = [f](Random& random, double overlap) {
    const double u = random.uniform(0, 2 * kPi), v = random.uniform(0, 2 * kPi), away = 0.7 - overlap * f.size;
    const double r = 1 + away * std::cos(v);
    Placement p;
    p.bInA = moved(random.rotation(), {r * std::cos(u), r * std::sin(u), away * std::sin(v)});
    const Distance distance = distanceToTorus(1, 0.4, p.bInA.t);
    p.truth = ballAndDistance(distance.value, distance.outward, 0.3);
    p.truth->depth = exitDepth(f, p.bInA, p.truth->direction, p.truth->depth);
    return p;
  };
  return f;
}

constexpr double kCylinderRadius = 0.5, kCylinderHeight = 2;

ContactFamily cylinders(const std::string& name, const std::string& what,
                        std::function<Transformd(Random&, double overlap, Vec3d& direction)> pose) {
  ContactFamily f;
  f.name = name;
  f.what = what;
  f.a = f.b = meshOf(scenes::makeCylinder(kCylinderRadius, kCylinderHeight, 64, 4));
  f.size = kCylinderRadius;
  f.place = [f, pose = std::move(pose)](Random& random, double overlap) {
    Placement p;
    Vec3d direction{};
    p.bInA = pose(random, overlap * f.size, direction);
    p.truth = convexTruth(f, p.bInA, direction);
    return p;
  };
  return f;
}

ContactFamily cylindersParallel() {
  return cylinders(
      "cylinders_parallel", "two cylinders side by side, axes parallel",
      [](Random& random, double overlap, Vec3d& direction) {
        const double u = random.uniform(0, 2 * kPi), r = 2 * kCylinderRadius - overlap;
        direction = {-std::cos(u), -std::sin(u), 0};
        const double along = random.uniform(-0.5, 0.5) * kCylinderHeight;
        return moved(about({0, 0, 1}, random.uniform(0, 2 * kPi)), {r * std::cos(u), r * std::sin(u), along});
      });
}

ContactFamily cylindersCrossed() {
  return cylinders("cylinders_crossed", "two cylinders across each other",
                   [](Random& random, double overlap, Vec3d& direction) {
                     const double u = random.uniform(0, 2 * kPi), r = 2 * kCylinderRadius - overlap;
                     const Vec3d n{std::cos(u), std::sin(u), 0};
                     direction = n * -1.0;
                     const double angle = random.uniform(kPi / 6, kPi / 2), spin = random.uniform(0, 2 * kPi);
                     const Transformd turn = product(about(n, angle), about({0, 0, 1}, spin));
                     const Vec3d axis = otgRotate(turn, Vec3d{0, 0, 1});
                     const Vec3d meeting{0, 0, random.uniform(-0.3, 0.3) * kCylinderHeight};
                     return moved(turn, meeting + n * r + axis * (random.uniform(-0.3, 0.3) * kCylinderHeight));
                   });
}

ContactFamily cylindersStacked() {
  return cylinders("cylinders_stacked", "a cylinder standing on another, off centre",
                   [](Random& random, double overlap, Vec3d& direction) {
                     const double side = random.sign(), u = random.uniform(0, 2 * kPi);
                     const double off = random.uniform(0, 0.8) * kCylinderRadius;
                     direction = {0, 0, -side};
                     return moved(about({0, 0, 1}, random.uniform(0, 2 * kPi)),
                                  {off * std::cos(u), off * std::sin(u), side * (kCylinderHeight - overlap)});
                   });
}

ContactFamily cylinderOnBox() {
  ContactFamily f;
  f.name = "cylinder_on_box";
  f.what = "a cylinder lying on a box, its ends may hang over";
  f.a = meshOf(scenes::makeBox({2, 2, 1}, 8));
  f.b = meshOf(scenes::makeCylinder(kCylinderRadius, kCylinderHeight, 64, 4));
  f.size = kCylinderRadius;
  f.place = [f](Random& random, double overlap) {
    const Transformd lying = product(about({0, 0, 1}, random.uniform(0, 2 * kPi)), about({1, 0, 0}, kPi / 2));
    Placement p;
    const double x = random.uniform(-0.6, 0.6), y = random.uniform(-0.6, 0.6);
    p.bInA = moved(product(lying, about({0, 0, 1}, random.uniform(0, 2 * kPi))),
                   {x, y, 0.5 + kCylinderRadius - overlap * f.size});
    p.truth = convexTruth(f, p.bInA, {0, 0, -1});
    return p;
  };
  return f;
}

ContactFamily toriStacked() {
  ContactFamily f;
  f.name = "tori_stacked";
  f.what = "a torus lying on an equal one: a ring of contact";
  f.a = f.b = meshOf(scenes::makeTorus(1, 0.3, 96, 48));
  f.size = 0.3;
  f.place = [f](Random& random, double overlap) {
    const double side = random.sign();
    Placement p;
    p.bInA = moved(about({0, 0, 1}, random.uniform(0, 2 * kPi)), {0, 0, side * (0.6 - overlap * f.size)});
    // Their highest rings face each other, facets and all: the extents along the axis give the depth.
    p.truth = convexTruth(f, p.bInA, {0, 0, -side});
    return p;
  };
  return f;
}

std::function<Placement(Random&, double)> anyhow(const ContactFamily& f) {
  return [f](Random& random, double overlap) {
    const Vec3d d = random.direction();
    const Transformd turn = random.rotation();
    return Placement{pushedTogether(f, turn, d, overlap * f.size), {}};
  };
}

}  // namespace

Vec3d Random::direction() {
  for (;;) {
    const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
    const double squared = x * x + y * y + z * z;
    if (squared > 0.01 && squared < 1) return Vec3d{x, y, z} * (1 / std::sqrt(squared));
  }
}

Transformd Random::rotation() {
  // Three uniform numbers to a uniform quaternion (Shoemake, Uniform random rotations, 1992).
  const double u = uniform(0, 1), v = uniform(0, 2 * kPi), w = uniform(0, 2 * kPi);
  const double a = std::sqrt(1 - u), b = std::sqrt(u);
  const double x = a * std::sin(v), y = a * std::cos(v), z = b * std::sin(w), s = b * std::cos(w);
  return {
      {1 - 2 * (y * y + z * z), 2 * (x * y - z * s), 2 * (x * z + y * s), 2 * (x * y + z * s), 1 - 2 * (x * x + z * z),
       2 * (y * z - x * s), 2 * (x * z - y * s), 2 * (y * z + x * s), 1 - 2 * (x * x + y * y)},
      {0, 0, 0}};
}

std::vector<ContactFamily> contactFamilies() {
  std::vector<ContactFamily> all;
  all.push_back(spheres());
  all.push_back(boxesOnFaces(false));
  all.push_back(boxesOnFaces(true));
  all.push_back(boxesTurned());
  all.push_back(ballOn("ball_box", "a ball on a box, faces, edges and corners", scenes::makeBox(kBoxA * 2.0, 2),
                       [](const Vec3d& p) { return distanceToBox(kBoxA, p); }));
  all.push_back(ballOn("ball_cylinder", "a ball on a cylinder, side, rim and cap",
                       scenes::makeCylinder(kCylinderRadius, kCylinderHeight, 64, 4),
                       [](const Vec3d& p) { return distanceToCylinder(kCylinderRadius, kCylinderHeight / 2, p); }));
  all.push_back(ballOnTorus());
  all.push_back(cylindersParallel());
  all.push_back(cylindersCrossed());
  all.push_back(cylindersStacked());
  all.push_back(cylinderOnBox());
  all.push_back(toriStacked());
  ContactFamily tori;
  tori.name = "tori";
  tori.what = "two tori turned at random";
  tori.a = tori.b = meshOf(scenes::makeTorus(1, 0.3, 96, 48));
  tori.size = 0.3;
  tori.place = anyhow(tori);
  all.push_back(tori);
  return all;
}

ContactFamily meshFamily(const std::string& name, const std::shared_ptr<const TriMesh>& mesh) {
  ContactFamily f;
  f.name = name;
  f.what = "two copies of the mesh turned at random";
  f.a = f.b = std::make_shared<CollisionMesh>(mesh, BuildStrategy::kSah);
  f.size = 0.25 * static_cast<double>(mesh->radius());
  f.place = anyhow(f);
  return f;
}

double wayOut(const ContactFamily& family, const Transformd& pose, const Vec3d& direction) {
  Workspace workspace;
  const auto meet = [&](double s) { return touch(family, moved(pose, direction * -s), workspace); };
  // Beyond the extents there is nothing left to meet.
  const double most = extentDepth(family.a->mesh(), family.b->mesh(), pose, direction), step = 0.01 * family.size;
  double inside = 0, outside = step;
  while (outside < most && meet(outside)) {
    inside = outside;
    outside += step;
  }
  while (outside - inside > 1e-6 * family.size) {
    const double middle = 0.5 * (inside + outside);
    (meet(middle) ? inside : outside) = middle;
  }
  return outside;
}

}  // namespace otg::truth
