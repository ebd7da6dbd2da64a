// SPDX-License-Identifier: BSD-3-Clause
// The SIMD stages of the pipeline: eight-way traversal and the filters for eight pairs of triangles.
//
// wide_kernels_impl.h is compiled once per instruction set (wide_kernels_<set>.cpp, with that set's compiler flags),
// and the choice is made at run time. Inside, everything is plain pointers and always-inlined formulas: the linker
// could keep an inline function of the standard library compiled there for the whole program, on machines without that
// instruction set, too. So the headers that it reads hold little but plain data. Eigen's, for one, leave functions
// behind in builds without optimisation. A test looks for such symbols (tests/unit/simd_symbols.sh).
#pragma once

#include "collide/pair_frame.h"
#include "collide/query.h"

namespace otg {

/// Instruction sets that the kernels are compiled for; results are the same bit for bit.
enum class SimdLevel { kBaseline, kAvx2, kAvx512 };

/// The best that this processor has.
SimdLevel bestSimdLevel();
const char* simdName(SimdLevel level);

/// Whether traverseWide() leaves pairs out whose boxes overlap and whose triangles are certainly apart: where a mesh has
/// thin triangles, whose boxes overlap most of what is near.
bool leavesOutThin(const Query& query);

/// Candidate pairs by the wide trees, in the order of traversal. Counts into `stats`.
void traverseWide(SimdLevel level, const Query& query, const PairFrame& frame, std::vector<TrianglePair>& out,
                  CollideStats& stats);

/// The float filter of the narrow phase (otgTrianglesFilter): the candidates that certainly intersect, and those
/// which float cannot decide; each in their order. Says nothing of degenerate triangles.
void filterTriangles(SimdLevel level, const Query& query, const PairFrame& frame,
                     const std::vector<TrianglePair>& candidates, std::vector<TrianglePair>& intersecting,
                     std::vector<TrianglePair>& undecided);

/// The double filter for what the float filter left: puts those of `undecided` that certainly intersect behind
/// `intersecting`, and leaves those that double cannot decide either.
void filterTrianglesInDouble(SimdLevel level, const Query& query, const PairFrame& frame,
                             std::vector<TrianglePair>& intersecting, std::vector<TrianglePair>& undecided);

}  // namespace otg
