// SPDX-License-Identifier: BSD-3-Clause
// What happened in a simulated scene: poses and contacts about 30 times a second, and the figures of every step. One
// recording serves the animation (gltf_animation.h), the page (html_page.h) and the pictures (povray_scene.h).
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "mesh/tri_mesh.h"
#include "scenes/simulation.h"

namespace otg::scenes {

struct AnimatedBody {
  std::string name;
  std::shared_ptr<const TriMesh> surface;
  Vec3d color{0.7, 0.7, 0.7};  ///< linear RGB
  /// One entry for each frame; a single entry for a body that stands still.
  std::vector<Vec3d> positions;                  ///< of the mesh's origin, world
  std::vector<std::array<double, 4>> rotations;  ///< quaternions w, x, y, z
};

/// A contact as it is drawn: an arrow from its position into a body that moves.
struct ContactArrow {
  Vec3d position{};   ///< world
  Vec3d direction{};  ///< unit length
  double depth = 0;   ///< penetration depth, metres
};

/// Of the simulation's last step.
std::vector<ContactArrow> arrowsOf(const Simulation& simulation);

struct StepFigures {
  StepRecord record;
  Energy energy;  ///< after the step
};

struct Recording {
  std::vector<AnimatedBody> bodies;
  std::vector<PlaneDescription> planes;
  double dt = 0;                                    ///< seconds a step
  int stepsPerFrame = 1;                            ///< frame i shows the world after step i * stepsPerFrame
  std::vector<double> times;                        ///< of the frames, seconds
  std::vector<std::vector<ContactArrow>> contacts;  ///< of each frame: those of the step that led there
  std::vector<StepFigures> steps;
};

/// Records a simulation as it goes on. The first frame is the world as it is when the recorder is made.
class Recorder {
 public:
  Recorder(const Simulation& simulation, double dt);
  /// After each step, with what that returned.
  void add(const Simulation& simulation, const StepRecord& record);
  const Recording& recording() const { return recording_; }

 private:
  void addFrame(const Simulation& simulation);
  Recording recording_;
};

struct Stage {
  Vec3d center{0, 0, 0};
  double radius = 1;
};

/// Around the places of the moving bodies in the second half of the time, where things have come together, with their
/// size added. A body that flies in from far away does not make all of them small.
Stage findStage(const std::vector<AnimatedBody>& bodies);

/// Arrows have one of these colours (linear RGB), from shallow to deep in equal steps up to usualDepth().
inline constexpr std::array<Vec3d, 5> kDepthColors = {{{0.871, 0.947, 0.015},
                                                       {0.939, 0.301, 0.051},
                                                       {0.604, 0.063, 0.188},
                                                       {0.209, 0.001, 0.392},
                                                       {0.004, 0.002, 0.242}}};
/// The number of a depth's colour.
std::size_t depthColor(double depth, double usual);

/// Where cameras stand, as seen from the middle of the stage; unit length.
inline constexpr Vec3d kViewFrom{0.246, -0.88, 0.406};

/// The depth that 95 of 100 recorded contacts do not exceed: the end of colour scales. 0 without contacts.
double usualDepth(const Recording& recording);

}  // namespace otg::scenes
