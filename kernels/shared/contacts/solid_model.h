// SPDX-License-Identifier: BSD-3-Clause
// The contact model `solid`: its thresholds, and the formulas that host and devices share. docs/contacts.md gives the
// model; the files that use these say in which order.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_SOLID_MODEL_D) : !defined(OTG_SHARED_SOLID_MODEL_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_SOLID_MODEL_D
#else
#define OTG_SHARED_SOLID_MODEL_F
#endif
#include "shared/math/vec3.h"
//
#include "shared/math/generic_begin.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

// Regions ------------------------------------------------------------------------------------------------------------

/// Regions of more vertices and clipped triangles than this are described by cells.
#define OTG_SOLID_LARGE_REGION 256

/// A region of less extent or area than these (in sizes of the smaller mesh, and their square) is left out.
#define OTG_SOLID_LEAST_DIAGONAL 1e-9
#define OTG_SOLID_LEAST_AREA 1e-18

/// Crossings of one edge that lie within the first of each other are ordered by how they drift (otgCrossesBefore);
/// within the second their rounding may have put them in the wrong order.
#define OTG_SOLID_ONE_POINT 1e-12
#define OTG_SOLID_CLOSE_POINTS 1e-9

// Normals ------------------------------------------------------------------------------------------------------------

/// From this coherence on a region counts as one flat face, and no piece of it is looked at.
#define OTG_SOLID_FLAT 0.9999

/// From the first on the mean direction holds everywhere, and up to the second the local one; in between they are
/// blended. At 0.99 and 0.97 the flanks of fine threads count as flat, and a nut loses 40 % of its way.
#define OTG_SOLID_STRAIGHT 0.997
#define OTG_SOLID_CURVED 0.99

/// Below this coherence the surfaces contradict each other.
#define OTG_SOLID_COHERENT 0.5

/// A piece says where out is as long as the way through the region behind it is not much longer than the region is
/// thick: see otgDepthWeight. The end of a slab over whose edge a box rests says nothing.
#define OTG_SOLID_THICK 4.0

/// Two sides whose directions differ by less (in radians) count alike; neither counts less than the second of these.
#define OTG_SOLID_SAME_DIRECTION 1e-3
#define OTG_SOLID_LEAST_SHARE 1e-3

/// How far (in diagonals) from a piece the way out may lead through its plane for it to count.
#define OTG_SOLID_PIECE_SLACK 0.02

/// More pieces than this are gathered in cells first, so that normals cost the same whatever the tessellation.
#define OTG_SOLID_MOST_ELEMENTS 256

/// Overlaps thicker than this part of their diagonal are deep: the shortest way out replaces the push.
#define OTG_SOLID_DEEP 0.06

/// Of a deep region three kinds of ways out are compared. One is along the push, whose way counts this much. One is
/// along the direction of the pair's last deep region, which is kept while it is nearly as short. Others are along up
/// to so many main directions of the faces of either mesh that go with the push, by this cosine at least. Normals that
/// agree to 15 degrees are one direction; so many are distinguished.
#define OTG_SOLID_PUSH_SHARE 0.98
#define OTG_SOLID_LAST_SHARE 0.85
#define OTG_SOLID_DEEP_FACES 6
#define OTG_SOLID_DEEP_AGAINST 0.2
#define OTG_SOLID_FACE_COSINE 0.966
#define OTG_SOLID_FACE_CLUSTERS 24

/// A thin part of one body that has gone far into the other has surfaces that cancel each other to this share. It
/// leaves another way than it came if that is no longer than this share of the way back.
#define OTG_SOLID_PIERCED 0.25
#define OTG_SOLID_PIERCED_SHARE 0.5

/// More pieces than the first are gathered by their normals for that; about so many points are looked at.
#define OTG_SOLID_DEEP_PIECES 128
#define OTG_SOLID_DEEP_POINTS 48

/// Cosine between a face and the way out from which on that face is the one to leave.
#define OTG_SOLID_FACING 0.5
/// A point of an uneven region is requested to go at most so many times its distance from such faces.
#define OTG_SOLID_NEIGHBOURHOOD 3.0

/// A region that reaches so many thicknesses along its push is uneven: it goes round a corner, or a thin contact has a
/// wedge beside it. There each point leaves by the faces nearest to it (collide/solid/leaving.h). Where those are
/// of a curved surface and its local normal agrees with one to 10 degrees, that serves, because it is smooth over
/// facets. What is within the last (in diagonals) of a triangle is on it. A deep one has a way out as a whole, unless
/// that is longer than so many thicknesses.
#define OTG_SOLID_UNEVEN 6.0
#define OTG_SOLID_LONG_WAY_OUT 4.0
#define OTG_SOLID_MOST_UNEVEN 2048  ///< vertices and clipped triangles; larger ones stay described by cells
#define OTG_SOLID_ONE_WAY 0.985
#define OTG_SOLID_ON_EDGE 1e-9

// Two edges across each other (collide/solid/edge_pair.h) -------------------------------------------------------------

/// From this coherence on a face says where out is.
#define OTG_SOLID_ONE_FACE 0.99

/// A region with more convex edges is more than a crossing of two.
#define OTG_SOLID_MOST_STRETCHES 4

/// Edges within 3 degrees of parallel have no stable direction across.
#define OTG_SOLID_LEAST_SINE 0.05

/// Cosine between a piece and the face of an edge that it counts as part of.
#define OTG_SOLID_SAME_FACE 0.9999

/// How much the way across two edges counts beside others, while the mean direction is the best of those.
#define OTG_SOLID_ACROSS_SHARE 0.97

// Points -------------------------------------------------------------------------------------------------------------

/// A crossing lies on both surfaces; it is measured this part of the region's diagonal further along its edge, or this
/// part of the inside stretch if that is less: then one at the thin end of a wedge has no depth, as it should. Every
/// point is measured this part below its own surface.
#define OTG_SOLID_INWARD 1e-3
#define OTG_SOLID_INWARD_OF_REACH 0.005
#define OTG_SOLID_BELOW_SURFACE 1e-6

/// A middle of a stretch that is not this much deeper than its ends are on average says nothing new.
#define OTG_SOLID_DEEPER_THAN_ENDS 1.05

/// A region of more vertices inside is hardly deeper anywhere than at these: its facets are small beside its depth.
#define OTG_SOLID_FEW_VERTICES 64

/// Candidates whose middles are nearer than this (in diagonals) and whose normals agree to 18 degrees are one.
#define OTG_SOLID_MERGE_DISTANCE 0.01
#define OTG_SOLID_MERGE_COSINE 0.951

/// Differences below these are no reason for a choice: bodies at rest tremble, and contacts should stay where they are.
#define OTG_SOLID_RANK_STEP 0.02
#define OTG_SOLID_FARTHER 1.02

/// A measured depth agrees with its estimate to within this.
#define OTG_SOLID_AGREES 0.02

/// Regions with more points or pieces of one mesh than this are thinned before anything quadratic.
#define OTG_SOLID_MOST_POINTS 192
#define OTG_SOLID_MOST_PLANES 96

/// Cells of a region's diagonal in which the planes and the points of those are gathered.
#define OTG_SOLID_PLANE_CELLS 12.0
#define OTG_SOLID_POINT_CELLS 10.0
/// Ranges of normals along a side of a cube, in which planes are gathered for deep regions.
#define OTG_SOLID_NORMAL_CELLS 7.0

/// Where planes stand for many triangles, a rim may pass for the deepest place: estimates that differ by less
/// say nothing, and so many candidates for each contact are measured by rays before the contacts are chosen.
#define OTG_SOLID_GATHERED_ERROR 0.05
#define OTG_SOLID_MEASURED_PER_CONTACT 3

/// Kinds of points, as PointKind.
#define OTG_POINT_VERTEX 0
#define OTG_POINT_CROSSING 1
#define OTG_POINT_MIDDLE 2
#define OTG_POINT_MIDDLE_OF_CONTOUR 3

/// What is gained by a contact that is so far (squared) from those chosen: where a body is held counts as much as how
/// firmly, or the shallow rim of a ring would take every place.
OTG_GENERIC REAL OTG_NAME(otgWorth)(REAL spread, REAL depth, REAL deepest) {
  const REAL least = OTG_REAL(0.01) * deepest;
  return spread * (depth > least ? depth : least);
}

/// Fraction of the region's deepest below which a point of this kind says nothing new: what is shallow there is so
/// because of where the point lies on its facet, not because the bodies touch less.
OTG_GENERIC REAL OTG_NAME(otgLeastOfKind)(otg_int kind, REAL deepest) {
  const REAL fraction = kind == OTG_POINT_VERTEX     ? OTG_REAL(0.005)
                        : kind == OTG_POINT_CROSSING ? OTG_REAL(0.02)
                        : kind == OTG_POINT_MIDDLE   ? OTG_REAL(0.65)
                                                     : OTG_REAL(0.3);
  return fraction * deepest;
}

/// Between equally deep points the vertex goes first: facets of a tessellated plane must not decide.
OTG_GENERIC REAL OTG_NAME(otgRankOfKind)(otg_int kind, REAL depth) {
  const REAL factor = kind == OTG_POINT_VERTEX     ? OTG_REAL(1.1)
                      : kind == OTG_POINT_CROSSING ? OTG_REAL(1.0)
                                                   : OTG_REAL(1.05);
  return depth * factor;
}

// Formulas -----------------------------------------------------------------------------------------------------------

OTG_GENERIC REAL OTG_NAME(otgNorm)(OTG_VEC3 v) {
  return OTG_SQRT(OTG_NAME(otgDot)(v, v));
}

/// v at length 1, or zero.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgUnit)(OTG_VEC3 v) {
  const REAL l = OTG_NAME(otgNorm)(v);
  return l > 0 ? OTG_NAME(otgScale)(v, 1 / l) : OTG_NAME(otgVec)(OTG_REAL(0), OTG_REAL(0), OTG_REAL(0));
}

/// Where the segment pq meets the plane of the triangle t: the parameter from p, clamped to the segment, and its change
/// as A moves. `mesh`: whose edge it is.
OTG_GENERIC REAL OTG_NAME(otgHitPlane)(otg_int mesh, OTG_VEC3 p, OTG_VEC3 q, const OTG_VEC3* t, OTG_VEC3* drift) {
  const OTG_VEC3 n = OTG_NAME(otgCross)(OTG_NAME(otgSub)(t[1], t[0]), OTG_NAME(otgSub)(t[2], t[0]));
  const REAL dp = OTG_NAME(otgDot)(n, OTG_NAME(otgSub)(p, t[0])), dq = OTG_NAME(otgDot)(n, OTG_NAME(otgSub)(q, t[0]));
  const REAL d = dp - dq;
  REAL at;
  if (d == 0) {
    *drift = OTG_NAME(otgVec)(OTG_REAL(0), OTG_REAL(0), OTG_REAL(0));
    return OTG_REAL(0.5);
  }
  *drift = OTG_NAME(otgScale)(n, (mesh == 0 ? OTG_REAL(1) : OTG_REAL(-1)) / d);
  at = dp / d;
  return at < 0 ? OTG_REAL(0) : 1 < at ? OTG_REAL(1) : at;
}

/// For two crossings at (nearly) the same place of their edge, which have these drifts, and leave the other mesh or
/// enter it: does x come before y once A has been moved by (e, e^2, e^3)? Where both are in one plane, as at two flush
/// boxes of a mesh, the edge leaves before it enters.
OTG_GENERIC otg_int OTG_NAME(otgCrossesBefore)(OTG_VEC3 x, otg_int xLeaves, OTG_VEC3 y, otg_int yLeaves) {
  const REAL a[3] = {x.x, x.y, x.z}, b[3] = {y.x, y.y, y.z};
  REAL most = 0;
  for (int k = 0; k < 3; ++k) {
    const REAL sum = OTG_ABS(a[k]) + OTG_ABS(b[k]);
    if (sum > most) most = sum;
  }
  for (int k = 0; k < 3; ++k) {
    if (OTG_ABS(a[k] - b[k]) > OTG_REAL(1e-9) * most) return a[k] < b[k];
  }
  return xLeaves != 0 && yLeaves == 0;
}

/// Of a piece, when the way through the region behind it is this long.
OTG_GENERIC REAL OTG_NAME(otgDepthWeight)(REAL way, REAL thickness) {
  const REAL share = way / (OTG_REAL(OTG_SOLID_THICK) * thickness);
  return 1 / (1 + share * share * share * share);
}

/// How far about a point the surface decides its normal. By area, not by extent: narrow along a thread or a rim, wide
/// in a round patch.
OTG_GENERIC REAL OTG_NAME(otgNormalReach)(REAL areas, REAL thickness) {
  const REAL byArea = OTG_REAL(0.6) * OTG_SQRT(OTG_REAL(0.5) * areas), byDepth = 3 * thickness;
  return byArea < byDepth ? byDepth : byArea;
}

/// Thick for its extent, so that it has one side where it comes out; a sheet may run around a rim.
OTG_GENERIC otg_int OTG_NAME(otgIsLump)(REAL thickness, REAL diagonal) {
  return thickness > OTG_REAL(0.05) * diagonal;
}

/// Whether a region whose surfaces contradict each other is thin between them, and both meshes have as much of it:
/// layers of overlap, as along the flanks of a thread. Through a plate that a body pierces no layer leads: the plate
/// has most.
OTG_GENERIC otg_int OTG_NAME(otgIsLayered)(REAL thickness, REAL diagonal, REAL areaA, REAL areaB) {
  return !OTG_NAME(otgIsLump)(thickness, diagonal) && areaA <= 2 * areaB && areaB <= 2 * areaA;
}

/// Whether a region that reaches so far along its push is far deeper at one place than it is on the whole.
OTG_GENERIC otg_int OTG_NAME(otgIsUneven)(REAL extent, REAL thickness) {
  return extent > OTG_REAL(OTG_SOLID_UNEVEN) * thickness;
}

/// Whether an uneven region is so far from out in its best direction that its parts leave each by its own face.
OTG_GENERIC otg_int OTG_NAME(otgIsLongWayOut)(REAL way, REAL thickness) {
  return way > OTG_REAL(OTG_SOLID_LONG_WAY_OUT) * thickness;
}

/// Whether the surfaces of one body in a region cancel each other. `push`: length of the sum of all their areas.
OTG_GENERIC otg_int OTG_NAME(otgIsPierced)(REAL push, REAL areaA, REAL areaB) {
  return push < OTG_REAL(OTG_SOLID_PIERCED) * (areaA < areaB ? areaB : areaA);
}

/// Whether the overlap ends at a crossing: the face that it is on is the one to leave along the contact's normal, and
/// nothing is below that there. `faceNormal`: of a crossing; zero for other points, where it does not. `mesh`: the
/// point's own.
OTG_GENERIC otg_int OTG_NAME(otgEndsAt)(OTG_VEC3 faceNormal, OTG_VEC3 normal, otg_uint mesh) {
  const REAL cosine = OTG_NAME(otgDot)(faceNormal, normal);
  return (mesh == 0 ? cosine : -cosine) > OTG_REAL(OTG_SOLID_FACING);
}

/// x, but no less than `low` and no more than `high`.
OTG_GENERIC REAL OTG_NAME(otgWithin)(REAL x, REAL low, REAL high) {
  return x < low ? low : high < x ? high : x;
}

/// How much B's surface counts where the sides say different things; A's counts the rest. From their directions `a` and
/// `b`, the region's, and the sides' coherences. Where the faces of the two sides differ in direction, an edge or
/// corner of one body is in a face of the other. The face says where out is. It is found as the direction between the
/// two that is nearest to the region's vector area, which holds the sides of that edge, too. A curved side is no face.
OTG_GENERIC REAL OTG_NAME(otgShareOfB)(OTG_VEC3 a, OTG_VEC3 b, OTG_VEC3 mean, REAL coherenceA, REAL coherenceB) {
  const OTG_VEC3 d = OTG_NAME(otgSub)(b, a), middle = OTG_NAME(otgScale)(OTG_NAME(otgAdd)(a, b), OTG_REAL(0.5));
  const REAL t = OTG_NAME(otgDot)(OTG_NAME(otgSub)(mean, middle), d) /
                 (OTG_NAME(otgDot)(d, d) + OTG_REAL(OTG_SOLID_SAME_DIRECTION) * OTG_REAL(OTG_SOLID_SAME_DIRECTION));
  const REAL coherence = t > 0 ? coherenceB : coherenceA;
  const REAL flatness = OTG_NAME(otgWithin)(
      (coherence - OTG_REAL(OTG_SOLID_CURVED)) / (OTG_REAL(OTG_SOLID_STRAIGHT) - OTG_REAL(OTG_SOLID_CURVED)),
      OTG_REAL(0), OTG_REAL(1));
  return OTG_NAME(otgWithin)(OTG_REAL(0.5) + flatness * t, OTG_REAL(OTG_SOLID_LEAST_SHARE),
                             1 - OTG_REAL(OTG_SOLID_LEAST_SHARE));
}

/// The local normal from the weighted sums of A's pieces (turned over) and B's: vectors and areas. Zero where they do
/// not say any.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgLocalNormal)(OTG_VEC3 a, REAL areaA, OTG_VEC3 b, REAL areaB, REAL shareOfB,
                                              otg_int isLump) {
  const REAL sA = OTG_NAME(otgNorm)(a), sB = OTG_NAME(otgNorm)(b), most = sA < sB ? sB : sA;
  // The sides of a lump must agree in amount too. Of a thin sheet one side alone may be near, which says as much.
  const REAL agreement = isLump ? most * most : sA * sB;
  const REAL lA = areaA > 0 ? sA / areaA : OTG_REAL(0), lB = areaB > 0 ? sB / areaB : OTG_REAL(0);
  const int apart = sA > 0 && sB > 0 && OTG_NAME(otgDot)(a, b) < OTG_REAL(0.3) * agreement;
  if (!(most > 0) || apart) return OTG_NAME(otgVec)(OTG_REAL(0), OTG_REAL(0), OTG_REAL(0));
  return OTG_NAME(otgUnit)(
      OTG_NAME(otgAdd)(OTG_NAME(otgScale)(a, (1 - shareOfB) * lA * lA), OTG_NAME(otgScale)(b, shareOfB * lB * lB)));
}

/// Where a candidate is measured: a little inside the region.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgProbe)(OTG_VEC3 position, OTG_VEC3 along, REAL reach, OTG_VEC3 surfaceNormal,
                                        otg_int kind, REAL diagonal, REAL thickness) {
  const REAL far = OTG_REAL(OTG_SOLID_INWARD) * diagonal, most = OTG_REAL(OTG_SOLID_INWARD_OF_REACH) * reach;
  const REAL inward = kind == OTG_POINT_CROSSING ? (most < far ? most : far) : OTG_REAL(0);
  const REAL ofExtent = OTG_REAL(OTG_SOLID_BELOW_SURFACE) * diagonal, ofDepth = OTG_REAL(0.01) * thickness;
  return OTG_NAME(otgSub)(OTG_NAME(otgAdd)(position, OTG_NAME(otgScale)(along, inward)),
                          OTG_NAME(otgScale)(surfaceNormal, ofDepth < ofExtent ? ofDepth : ofExtent));
}

/// Where the stretch of edge p passes the stretch of edge q of the other mesh, seen along n: how far from its middle,
/// and how far p must go along n to reach q; a length of 0 or less says nothing. `apart`: from the middle of p to that
/// of q.
#ifdef __OPENCL_VERSION__
#define OTG_STRETCH_PASS OTG_NAME(otg_stretch_pass)
typedef struct {
  REAL at, way;
} OTG_STRETCH_PASS;
#else
template <class REAL>
struct StretchPass {
  REAL at, way;
};
#define OTG_STRETCH_PASS StretchPass<REAL>
#endif
OTG_GENERIC OTG_STRETCH_PASS OTG_NAME(otgPassOfStretches)(OTG_VEC3 apart, OTG_VEC3 alongP, REAL reachP, OTG_VEC3 alongQ,
                                                          REAL reachQ, OTG_VEC3 n) {
  OTG_STRETCH_PASS pass;
  const REAL across = OTG_NAME(otgDot)(OTG_NAME(otgCross)(alongP, alongQ), n);
  REAL atQ;
  pass.at = pass.way = OTG_REAL(0);
  if (OTG_ABS(across) < OTG_REAL(OTG_SOLID_LEAST_SINE)) return pass;
  pass.at = OTG_NAME(otgDot)(OTG_NAME(otgCross)(apart, alongQ), n) / across;
  atQ = OTG_NAME(otgDot)(OTG_NAME(otgCross)(apart, alongP), n) / across;
  if (OTG_ABS(pass.at) > reachP || OTG_ABS(atQ) > reachQ) return pass;
  pass.way = OTG_NAME(otgDot)(apart, n) - pass.at * OTG_NAME(otgDot)(alongP, n) + atQ * OTG_NAME(otgDot)(alongQ, n);
  return pass;
}

/// Whether stretches of these half lengths are too far from each other to pass, seen along n. Less costly to tell.
OTG_GENERIC otg_int OTG_NAME(otgAreBeside)(OTG_VEC3 apart, REAL reachP, REAL reachQ, OTG_VEC3 n) {
  const REAL along = OTG_NAME(otgDot)(apart, n), reach = reachP + reachQ;
  return OTG_NAME(otgDot)(apart, apart) - along * along > (1 + OTG_REAL(1e-6)) * reach * reach;
}

/// Whether the depth that rays measured is that of a side of a face and not of the face ahead. Where edges cross at the
/// rim of a face, a ray along the normal runs in the side wall. Rounding says how soon it leaves. The region's planes
/// and the crossing of the edges are more exact there. `passes`: OTG_STRETCH_PASS::way, or 0.
OTG_GENERIC otg_int OTG_NAME(otgLeavesBeside)(REAL measured, REAL estimate, REAL passes) {
  return measured < (1 - OTG_REAL(OTG_SOLID_AGREES)) * (estimate < passes ? estimate : passes);
}

/// How far from a middle its stretch's ends are looked at.
OTG_GENERIC REAL OTG_NAME(otgReachOfEnds)(REAL reach, REAL diagonal) {
  const REAL shortened = reach - OTG_REAL(OTG_SOLID_INWARD) * diagonal, most = OTG_REAL(0.5) * reach;
  return shortened < most ? most : shortened;
}

/// In how many steps of OTG_SOLID_RANK_STEP below the highest a rank lies.
OTG_GENERIC otg_int OTG_NAME(otgRankStep)(REAL rank, REAL highest) {
  return highest > 0 ? OTG_INT((highest - rank) / (OTG_REAL(OTG_SOLID_RANK_STEP) * highest)) : 0;
}

/// Squared distance of candidates in position (in diagonals: `scale` is 1 / diagonal^2) and normal.
OTG_GENERIC REAL OTG_NAME(otgApart)(OTG_VEC3 p, OTG_VEC3 n, OTG_VEC3 q, OTG_VEC3 m, REAL scale) {
  const OTG_VEC3 d = OTG_NAME(otgSub)(p, q), e = OTG_NAME(otgSub)(n, m);
  return OTG_NAME(otgDot)(d, d) * scale + OTG_NAME(otgDot)(e, e);
}

/// Whether an edge whose two faces have these outward normals is convex. `along`: the edge in the direction in which
/// the face of n0 lies to its left.
OTG_GENERIC otg_int OTG_NAME(otgIsConvex)(OTG_VEC3 n0, OTG_VEC3 n1, OTG_VEC3 along) {
  return OTG_NAME(otgDot)(OTG_NAME(otgCross)(n0, n1), along) > 0;
}

/// Whether d, which is perpendicular to the edge, lies between the outward normals of its faces.
OTG_GENERIC otg_int OTG_NAME(otgIsBetween)(OTG_VEC3 n0, OTG_VEC3 n1, OTG_VEC3 d) {
  const REAL cosine = OTG_NAME(otgDot)(n0, n1), x = OTG_NAME(otgDot)(d, n0), y = OTG_NAME(otgDot)(d, n1);
  return x >= cosine * y && y >= cosine * x;
}

/// Whether a region is a lump, rather than a layer between two surfaces.
OTG_GENERIC otg_int OTG_NAME(otgIsThick)(REAL thickness, REAL diagonal) {
  return thickness > OTG_REAL(OTG_SOLID_DEEP) * diagonal;
}

/// What the surface of a region says of it. `a`, `b`: sums of the vector areas of A's pieces and of B's; `moment`: sum
/// of (normal . x) area; [lo, hi]: bounds of its points.
#ifdef __OPENCL_VERSION__
#define OTG_REGION_MEASURE OTG_NAME(otg_region_measure)
typedef struct {
  OTG_VEC3 push;
  REAL volume, diagonal, thickness, coherence;
  int bad;
} OTG_REGION_MEASURE;
#else
template <class REAL>
struct RegionMeasure {
  Vec3<REAL> push;  ///< halved difference of the vector areas: points out of B
  REAL volume, diagonal;
  REAL thickness;  ///< 2 volume / (areaA + areaB)
  REAL coherence;  ///< 1 for a flat patch, 0 when the pieces' areas cancel
  int bad;         ///< the surface does not close, or the volume is negative
};
#define OTG_REGION_MEASURE RegionMeasure<REAL>
#endif
OTG_GENERIC OTG_REGION_MEASURE OTG_NAME(otgMeasureRegion)(OTG_VEC3 a, OTG_VEC3 b, REAL areaA, REAL areaB, REAL moment,
                                                          OTG_VEC3 lo, OTG_VEC3 hi) {
  OTG_REGION_MEASURE m;
  const OTG_VEC3 middle = OTG_NAME(otgScale)(OTG_NAME(otgAdd)(lo, hi), OTG_REAL(0.5)), all = OTG_NAME(otgAdd)(a, b);
  const REAL total = areaA + areaB;
  REAL push, thickness, byA, byB, most;
  m.diagonal = OTG_NAME(otgNorm)(OTG_NAME(otgSub)(hi, lo));
  m.volume = (moment - OTG_NAME(otgDot)(all, middle)) / 3;
  m.push = OTG_NAME(otgScale)(OTG_NAME(otgSub)(b, a), OTG_REAL(0.5));
  thickness = total > 0 ? 2 * m.volume / total : OTG_REAL(0);
  m.thickness = thickness > 0 ? thickness : OTG_REAL(0);
  push = OTG_NAME(otgNorm)(m.push);
  byA = areaA > 0 ? push / areaA : OTG_REAL(0);
  byB = areaB > 0 ? push / areaB : OTG_REAL(0);
  most = byA < byB ? byB : byA;
  m.coherence = most < 1 ? most : OTG_REAL(1);
  m.bad = OTG_NAME(otgNorm)(all) > OTG_REAL(0.05) * total || m.volume < OTG_REAL(-1e-3) * total * m.diagonal;
  return m;
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#undef OTG_REGION_MEASURE
#undef OTG_STRETCH_PASS
#include "shared/math/generic_end.h"
#endif
