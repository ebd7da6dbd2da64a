// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/recording.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/vectors.h"

namespace otg::scenes {
namespace {

constexpr Vec3d kBodyColors[] = {{0.55, 0.55, 0.55}, {0.80, 0.25, 0.12}, {0.10, 0.35, 0.75},
                                 {0.85, 0.60, 0.08}, {0.15, 0.55, 0.25}, {0.50, 0.20, 0.60}};

bool moves(const Simulation& simulation, std::size_t body) {
  return body != kNoBody && !simulation.description(body).isStatic;
}

}  // namespace

Recorder::Recorder(const Simulation& simulation, double dt) {
  recording_.dt = dt;
  recording_.stepsPerFrame = std::max(1, int(std::lround(1 / (30 * dt))));
  recording_.planes = simulation.scene().planes;
  for (std::size_t i = 0; i < simulation.bodyCount(); ++i) {
    AnimatedBody& body = recording_.bodies.emplace_back();
    body.name = simulation.description(i).name;
    body.surface = surfaceOf(simulation.description(i));
    body.color = simulation.description(i).color.value_or(kBodyColors[i % std::size(kBodyColors)]);
  }
  addFrame(simulation);
}

void Recorder::add(const Simulation& simulation, const StepRecord& record) {
  recording_.steps.push_back({record, simulation.energy()});
  if (recording_.steps.size() % std::size_t(recording_.stepsPerFrame) == 0) addFrame(simulation);
}

void Recorder::addFrame(const Simulation& simulation) {
  recording_.times.push_back(double(recording_.steps.size()) * recording_.dt);
  for (std::size_t i = 0; i < recording_.bodies.size(); ++i) {
    AnimatedBody& body = recording_.bodies[i];
    if (simulation.description(i).isStatic && !body.positions.empty()) continue;
    const BodyState state = simulation.state(i);
    body.positions.push_back(state.position);
    body.rotations.push_back(state.rotation);
  }
  recording_.contacts.push_back(arrowsOf(simulation));
}

std::vector<ContactArrow> arrowsOf(const Simulation& simulation) {
  std::vector<ContactArrow> arrows;
  for (const StepContact& contact : simulation.contacts()) {
    // ODE's normal points into the first body.
    const bool turned = !moves(simulation, contact.a) && moves(simulation, contact.b);
    arrows.push_back({contact.position, turned ? contact.normal * -1.0 : contact.normal, contact.depth});
  }
  return arrows;
}

Stage findStage(const std::vector<AnimatedBody>& bodies) {
  Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const AnimatedBody& body : bodies) {
    if (body.positions.size() < 2) continue;
    const double r = body.surface->radius();
    for (std::size_t i = body.positions.size() / 2; i < body.positions.size(); ++i) {
      const Vec3d& p = body.positions[i];
      low = {std::min(low.x, p.x - r), std::min(low.y, p.y - r), std::min(low.z, p.z - r)};
      high = {std::max(high.x, p.x + r), std::max(high.y, p.y + r), std::max(high.z, p.z + r)};
    }
  }
  if (low.x > high.x) return {};
  const Vec3d size = high - low;
  return {(low + high) * 0.5, 0.5 * norm(size)};
}

std::size_t depthColor(double depth, double usual) {
  const double share = usual > 0 ? std::clamp(depth / usual, 0.0, 1.0) : 0.0;
  return std::min(kDepthColors.size() - 1, static_cast<std::size_t>(share * double(kDepthColors.size())));
}

double usualDepth(const Recording& recording) {
  std::vector<double> depths;
  for (const auto& frame : recording.contacts) {
    for (const ContactArrow& arrow : frame) depths.push_back(arrow.depth);
  }
  if (depths.empty()) return 0;
  const auto place = depths.begin() + std::ptrdiff_t(0.95 * double(depths.size() - 1));
  std::nth_element(depths.begin(), place, depths.end());
  return *place;
}

}  // namespace otg::scenes
