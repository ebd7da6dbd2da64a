// SPDX-License-Identifier: BSD-3-Clause
// Bullet: two GImpact meshes through contactPairTest.
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>

#include "peers/peer.h"

namespace otg::peers {
namespace {

struct Collect final : btCollisionWorld::ContactResultCallback {
  std::vector<double> numbers;
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    const btVector3 &p = point.getPositionWorldOnA(), &n = point.m_normalWorldOnB;
    numbers.insert(numbers.end(), {p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), point.getDistance()});
    return 0;
  }
};

/// Bullet keeps pointers into these arrays.
struct Mesh {
  std::vector<int> indices;
  std::vector<btScalar> vertices;
  std::unique_ptr<btTriangleIndexVertexArray> arrays;
  std::unique_ptr<btGImpactMeshShape> shape;

  explicit Mesh(const TriMesh& mesh) {
    for (const Triangle& t : mesh.triangles()) {
      for (const std::uint32_t v : t.v) indices.push_back(static_cast<int>(v));
    }
    for (const Vec3f& v : mesh.vertices()) vertices.insert(vertices.end(), {v.x, v.y, v.z});
    arrays = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(mesh.triangleCount()), indices.data(), static_cast<int>(3 * sizeof(int)),
        static_cast<int>(mesh.vertices().size()), vertices.data(), static_cast<int>(3 * sizeof(btScalar)));
    shape = std::make_unique<btGImpactMeshShape>(arrays.get());
    shape->setMargin(0);
    shape->updateBound();
  }
};

class BulletPeer final : public Peer {
 public:
  explicit BulletPeer(const PeerScene& scene) : a_(*scene.a), b_(*scene.b) {
    // contactPairTest looks up the algorithm of closest points, which registerAlgorithm does not set for GImpact
    // shapes: without the loop it finds nothing, and says nothing.
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
    for (int type = 0; type < MAX_BROADPHASE_COLLISION_TYPES; ++type) {
      dispatcher_.registerClosestPointsCreateFunc(GIMPACT_SHAPE_PROXYTYPE, type, &create_);
      dispatcher_.registerClosestPointsCreateFunc(type, GIMPACT_SHAPE_PROXYTYPE, &create_);
    }
    objectA_.setCollisionShape(a_.shape.get());
    objectB_.setCollisionShape(b_.shape.get());
    const double* r = scene.bInA.r;
    const auto s = [](double x) { return static_cast<btScalar>(x); };
    objectB_.setWorldTransform(
        btTransform(btMatrix3x3(s(r[0]), s(r[1]), s(r[2]), s(r[3]), s(r[4]), s(r[5]), s(r[6]), s(r[7]), s(r[8])),
                    btVector3(s(scene.bInA.t.x), s(scene.bInA.t.y), s(scene.bInA.t.z))));
    objectA_.setWorldTransform(btTransform::getIdentity());
  }
  void query() override {
    result_.numbers.clear();
    world_.contactPairTest(&objectA_, &objectB_, result_);
  }
  std::size_t resultCount() const override { return result_.numbers.size() / 7; }
  std::vector<double> resultNumbers() const override { return result_.numbers; }
  std::vector<PeerContact> contacts() const override {
    std::vector<PeerContact> all;
    for (std::size_t i = 0; i + 6 < result_.numbers.size(); i += 7) {
      const double* x = &result_.numbers[i];
      // The normal points from B to A, the distance is negative where they overlap, and the point lies on A; the one on
      // B lies the distance against the normal. Half way between them is what the others give.
      const Vec3d normal{x[3], x[4], x[5]};
      all.push_back({otgSub({x[0], x[1], x[2]}, otgScale(normal, 0.5 * x[6])), normal, -x[6]});
    }
    return all;
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btGImpactCollisionAlgorithm::CreateFunc create_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btCollisionWorld world_{&dispatcher_, &broadphase_, &configuration_};
  Mesh a_, b_;
  btCollisionObject objectA_, objectB_;
  Collect result_;
};

}  // namespace

std::unique_ptr<Peer> makeBulletPeer(const PeerScene& scene) {
  return std::make_unique<BulletPeer>(scene);
}

}  // namespace otg::peers
