// SPDX-License-Identifier: BSD-3-Clause
// FCL: BVHModel of oriented boxes, all contacts.
#include <fcl/fcl.h>

#include <limits>

#include "peers/peer.h"

namespace otg::peers {
namespace {

using Model = fcl::BVHModel<fcl::OBBd>;

std::shared_ptr<Model> build(const TriMesh& mesh) {
  std::vector<fcl::Vector3d> points;
  for (const Vec3f& v : mesh.vertices()) points.emplace_back(v.x, v.y, v.z);
  std::vector<fcl::Triangle> triangles;
  for (const Triangle& t : mesh.triangles()) triangles.emplace_back(t.v[0], t.v[1], t.v[2]);
  auto model = std::make_shared<Model>();
  model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
  model->addSubModel(points, triangles);
  model->endModel();
  return model;
}

class FclPeer final : public Peer {
 public:
  explicit FclPeer(const PeerScene& scene) : a_(build(*scene.a)), b_(scene.b == scene.a ? a_ : build(*scene.b)) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) pose_.linear()(i, j) = scene.bInA.r[3 * i + j];
    }
    pose_.translation() = fcl::Vector3d(scene.bInA.t.x, scene.bInA.t.y, scene.bInA.t.z);
  }
  void query() override {
    const fcl::CollisionRequestd request(std::numeric_limits<std::size_t>::max(), true);
    result_.clear();
    fcl::collide(a_.get(), fcl::Transform3d::Identity(), b_.get(), pose_, request, result_);
  }
  std::size_t resultCount() const override { return result_.numContacts(); }
  std::vector<double> resultNumbers() const override {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < result_.numContacts(); ++i) {
      const auto& c = result_.getContact(i);
      numbers.insert(numbers.end(), {c.pos.x(), c.pos.y(), c.pos.z(), c.normal.x(), c.normal.y(), c.normal.z(),
                                     c.penetration_depth, double(c.b1), double(c.b2)});
    }
    return numbers;
  }
  std::vector<PeerContact> contacts() const override {
    std::vector<PeerContact> all;
    for (std::size_t i = 0; i < result_.numContacts(); ++i) {
      const auto& c = result_.getContact(i);
      // Its normals point from the first object to the second.
      all.push_back(
          {{c.pos.x(), c.pos.y(), c.pos.z()}, {-c.normal.x(), -c.normal.y(), -c.normal.z()}, c.penetration_depth});
    }
    return all;
  }

 private:
  std::shared_ptr<Model> a_, b_;
  fcl::Transform3d pose_ = fcl::Transform3d::Identity();
  fcl::CollisionResultd result_;
};

}  // namespace

std::unique_ptr<Peer> makeFclPeer(const PeerScene& scene) {
  return std::make_unique<FclPeer>(scene);
}

}  // namespace otg::peers
