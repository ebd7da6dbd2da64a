// SPDX-License-Identifier: BSD-3-Clause
// Children made by fork(): what they find in meshes that their parent has used, and how they end.
#pragma once

#include <ode/ode.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "support/catch.h"
#include "support/ode_world.h"

namespace otg::test {

/// How a child ends that is done with its work.
enum class ChildEnd { kExit, kQuickExit, kExec };

/// A pile of lumps that the parent has collided already.
class ForkScene {
 public:
  ForkScene() : data_(scenes::makeLump(0.5, 3, 0.2, 4)) {
    for (int i = 0; i < 8; ++i) {
      geoms_.push_back(dCreateGpuTriMesh(nullptr, data_.id));
      dGeomSetPosition(geoms_.back(), 0.6 * i, 0.05 * i, 0.1 * i);
    }
    for (int i = 0; i + 1 < 8; ++i) pairs_.push_back({geoms_[i], geoms_[i + 1]});
    wanted_ = contacts();
  }
  ~ForkScene() {
    for (const dGeomID g : geoms_) dGeomDestroy(g);
  }
  ForkScene(const ForkScene&) = delete;
  ForkScene& operator=(const ForkScene&) = delete;

  const std::vector<dGpuTriMeshPair>& pairs() const { return pairs_; }
  bool hasContacts() const { return !wanted_.empty(); }

  /// By threads, and one by one.
  bool isAsBefore() const {
    if (!sameContacts(contacts(), wanted_)) return false;
    std::vector<dContactGeom> single;
    for (const dGpuTriMeshPair& pair : pairs_) {
      const auto some = collide(pair.o1, pair.o2, kMost);
      single.insert(single.end(), some.begin(), some.end());
    }
    return sameContacts(single, wanted_);
  }
  /// A thousand queries of a child, with the threads that it finds and with others.
  bool areAllAsBefore() const {
    for (int round = 0; round < 70; ++round) {  // of 14 pairs
      if (round == 35 && dGpuTriMeshSetThreadCount(3) != dGPUTRIMESH_OK) return false;
      if (!isAsBefore()) return false;
    }
    return true;
  }

 private:
  static constexpr int kMost = 64;
  std::vector<dContactGeom> contacts() const {
    std::vector<dContactGeom> places(kMost * pairs_.size()), all;
    std::vector<int> counts(pairs_.size());
    const int sum = dGpuTriMeshCollidePairs(pairs_.data(), static_cast<int>(pairs_.size()), kMost, places.data(),
                                            sizeof(dContactGeom), counts.data());
    if (sum < 0) return {};
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto first = places.begin() + static_cast<std::ptrdiff_t>(kMost * i);
      all.insert(all.end(), first, first + counts[i]);
    }
    return all;
  }

  const Data data_;
  std::vector<dGeomID> geoms_;
  std::vector<dGpuTriMeshPair> pairs_;
  std::vector<dContactGeom> wanted_;
};

/// Forks, has the child do its work and end, and waits for that. "" if the work was right and the child ended by itself
/// with status 0.
template <class Work>
std::string childFault(ChildEnd end, const Work& work) {
  constexpr int kWrong = 3;
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) return "no child";
  if (child == 0) {
    if (!work()) _exit(kWrong);
    if (end == ChildEnd::kExec) execl("/bin/true", "true", static_cast<char*>(nullptr));
    if (end == ChildEnd::kQuickExit) _exit(0);
    std::exit(0);
  }
  int status = 0;
  for (int waited = 0; waitpid(child, &status, WNOHANG) == 0; ++waited) {
    if (waited == 60000) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return "it hangs";
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (WIFSIGNALED(status)) return "it ended by signal " + std::to_string(WTERMSIG(status));
  if (WEXITSTATUS(status) == kWrong) return "its answers are others";
  return WEXITSTATUS(status) == 0 ? "" : "it ended with status " + std::to_string(WEXITSTATUS(status));
}

inline const char* nameOf(ChildEnd end) {
  return end == ChildEnd::kExit ? "exit" : end == ChildEnd::kExec ? "exec" : "_exit";
}
inline constexpr ChildEnd kChildEnds[] = {ChildEnd::kExit, ChildEnd::kQuickExit, ChildEnd::kExec};

/// Children that do nothing, collide, and collide in children of their own.
inline void checkChildren(const ForkScene& scene) {
  for (const ChildEnd end : kChildEnds) {
    INFO(nameOf(end));
    CHECK(childFault(end, [] { return true; }) == "");
    CHECK(childFault(end, [&] { return scene.areAllAsBefore(); }) == "");
    CHECK(childFault(end, [&] {
            return childFault(end, [&] { return scene.isAsBefore(); }).empty() && scene.isAsBefore();
          }) == "");
  }
  CHECK(scene.isAsBefore());  // the parent's
}

}  // namespace otg::test
