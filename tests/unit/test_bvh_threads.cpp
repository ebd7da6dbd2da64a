// SPDX-License-Identifier: BSD-3-Clause
// Layouts that are made on first use, asked for by many threads at once. Run under ThreadSanitizer this also shows that
// nobody reads a layout before it is finished.
#include <atomic>
#include <thread>

#include "bvh/collision_mesh.h"
#include "support/catch.h"
#include "support/mesh_samples.h"

using namespace otg;
using namespace otg::samples;

TEST_CASE("layouts are made once however many threads ask first") {
  constexpr int kThreads = 8, kRounds = 20;
  const MeshPtr mesh = scenes::build(scenes::makeTorus(1, 0.3, 40, 20));
  for (int round = 0; round < kRounds; ++round) {
    const CollisionMesh shared(mesh, BuildStrategy::kSah);
    std::atomic<int> waiting{kThreads};
    struct Answer {
      const QuantizedTree* quantized = nullptr;
      const NoLeafTree* noLeaf = nullptr;
      const WideTree* wide = nullptr;
      std::string error = "not run";
    };
    std::vector<Answer> answers(kThreads);
    std::vector<std::thread> threads;
    for (int i = 0; i < kThreads; ++i) {
      threads.emplace_back([&, i] {
        Answer& answer = answers[static_cast<std::size_t>(i)];
        --waiting;
        while (waiting > 0) std::this_thread::yield();
        // In a different order in every other thread.
        if (i % 2 == 0) answer.wide = &shared.wide();
        answer.quantized = &shared.quantized();
        answer.noLeaf = &shared.noLeaf();
        answer.wide = &shared.wide();
        answer.error = validateLayout(*answer.quantized, *mesh) + validateLayout(*answer.noLeaf, *mesh) +
                       validateLayout(*answer.wide, *mesh);
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (const Answer& answer : answers) {
      REQUIRE(answer.error == "");
      REQUIRE(answer.quantized == &shared.quantized());
      REQUIRE(answer.noLeaf == &shared.noLeaf());
      REQUIRE(answer.wide == &shared.wide());
    }
  }
}

TEST_CASE("images of a mesh are made, and ask for the layouts that they share, in several threads at once") {
  constexpr int kThreads = 6, kRounds = 20;
  const MeshPtr mesh = scenes::build(scenes::makeTorus(1, 0.3, 40, 20));
  for (int round = 0; round < kRounds; ++round) {
    const CollisionMesh shared(mesh, BuildStrategy::kSah);
    std::atomic<int> waiting{kThreads};
    std::vector<std::unique_ptr<CollisionMesh>> images(kThreads);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < kThreads; ++i) {
      threads.emplace_back([&, i] {
        const Vec3f by{i % 2 == 0 ? 1.0f : -1.0f, 1 + static_cast<float>(i), 2};
        const MeshPtr image = scaledMesh(*mesh, by);
        --waiting;
        while (waiting > 0) std::this_thread::yield();
        images[i] = std::make_unique<CollisionMesh>(image, shared, by);
        images[i]->wide();
        images[i]->noLeaf();
        images[i]->quantized();
        images[i]->adjacency();
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (const auto& image : images) {
      REQUIRE(image->boxScale() != nullptr);
      REQUIRE(&image->wide() == &shared.wide());
      REQUIRE(&image->noLeaf() == &shared.noLeaf());
      REQUIRE(&image->quantized() == &shared.quantized());
    }
  }
}

TEST_CASE("a refitted mesh makes its own layouts") {
  const MeshPtr mesh = scenes::build(scenes::makeSphere(1, 2));
  const CollisionMesh before(mesh, BuildStrategy::kSah);
  const QuantizedTree* layout = &before.quantized();
  const CollisionMesh after(mesh, before);
  REQUIRE(&after.quantized() != layout);
  REQUIRE(validateLayout(after.quantized(), *mesh) == "");
}
