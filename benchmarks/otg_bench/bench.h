// SPDX-License-Identifier: BSD-3-Clause
// The benchmarks of `otg bench`.
#pragma once

#include "otg_bench/scene.h"

namespace otg::cli {

/// The published tables: the whole query step by step, box tests by depth, and every combination of build strategy,
/// traversal and descent rule.
int benchThesis(const BenchOptions& options);
/// Single pairs and batches of pairs on an OpenCL device and on the CPU.
int benchBatch(const BenchOptions& options);
/// Validation, both build strategies, the derived layouts, refit.
int benchBuild(const BenchOptions& options);
/// The whole query beside other collision libraries, stock ODE first.
int benchPeers(const BenchOptions& options);

/// `otg bench threads`: queries from several threads at once, and batches worked on by several threads.
void addBenchThreads(CLI::App& bench, Action& action);
/// `otg bench contacts`: single queries against the truth.
void addBenchContacts(CLI::App& bench, Action& action);
/// `otg bench primitives`: meshes against ODE's shapes, beside ODE's own pairs.
void addBenchPrimitives(CLI::App& bench, Action& action);
/// `otg bench tessellations`: two meshes of convex bodies, against the bodies by formula.
void addBenchTessellations(CLI::App& bench, Action& action);
/// `otg bench terrain`: ODE's shapes on a large open mesh, beside a dTriMesh.
void addBenchTerrain(CLI::App& bench, Action& action);
/// `otg bench floor`: meshes that stand on a floor, beside dTriMesh geoms.
void addBenchFloor(CLI::App& bench, Action& action);
/// `otg bench small`: pairs of small bodies, beside ODE's own shapes and its dTriMesh.
void addBenchSmall(CLI::App& bench, Action& action);
/// `otg bench shapes`: ODE's shapes on small and convex meshes, beside a dTriMesh.
void addBenchShapes(CLI::App& bench, Action& action);
/// `otg bench world`: whole steps of scenes, split in collision, joints and solver.
void addBenchWorld(CLI::App& bench, Action& action);
/// `otg bench heightfield`: meshes on a heightfield, beside ODE's own bodies.
void addBenchHeightfield(CLI::App& bench, Action& action);
/// `otg bench queries`: arrays of points against a mesh.
void addBenchQueries(CLI::App& bench, Action& action);
/// `otg bench contours`: random overlaps, and what the model `solid` could not work with.
void addBenchContours(CLI::App& bench, Action& action);
/// `otg bench exact`: hard pairs of triangles against exact arithmetic.
void addBenchExact(CLI::App& bench, Action& action);
/// `otg bench physics`, which has options of its own: worlds of mesh bodies judged against limits.
void addBenchPhysics(CLI::App& bench, Action& action);

/// All of these.
void addBenchmarks(CLI::App& bench, Action& action);

/// `{"bench": name, ..., "tables": {title: rows}}` as JSON or as readable tables.
void printBench(const Json& document, bool json);

}  // namespace otg::cli
