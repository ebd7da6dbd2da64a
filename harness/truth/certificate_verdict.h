// SPDX-License-Identifier: BSD-3-Clause
// What the judge says of one pair, and of a family of them.
#pragma once

#include <string>
#include <vector>

#include "truth/certificate.h"
#include "truth/certificate_families.h"
#include "truth/contact_errors.h"
#include "truth/pair_in_ode.h"

namespace otg::truth {

inline constexpr double kMostLeft = 0.02;   ///< part of the overlap that a certified set may leave
inline constexpr double kMostLength = 3;    ///< |asked| over the shortest separating translation, always
inline constexpr double kGoodLength = 1.5;  ///< and in 95 % of cases

struct Verdict {
  int number = 0;
  Certificate certificate;
  double length = 0;  ///< |asked| over the shortest translation that separates
  double tilt = 0;    ///< degrees between the two
  int contacts = 0, tooDeep = 0;
  bool orderMatters = false;   ///< other contacts when the geoms are created in the other order
  bool orderMuch = false;      ///< by more than a thousandth of the smaller body, or of the normal's length
  bool callMatters = false;    ///< or when they are given in the other order
  bool updateMatters = false;  ///< or when vertices came by an update
  bool certified() const { return !certificate.none && !certificate.infeasible && certificate.left <= kMostLeft; }
  /// The greater, the worse: without contacts, without a translation, overlapped after it, too far.
  double badness() const;
};

/// ODE and the geom class must be initialised.
Verdict judge(const CertificateMember& member, int number, const GeomChoices& choices);

struct FamilyVerdict {
  int members = 0, notDrawn = 0;
  int none = 0, infeasible = 0, left = 0;  ///< members without certificate, by reason
  int leftWay = 0;                         ///< members of which more is left by the way than kMostLeft
  int tooLong = 0;                         ///< members with one that requests over kMostLength
  int longer = 0;                          ///< or over kGoodLength, those among them
  int tooDeep = 0;                         ///< members with contacts that are
  int order = 0, call = 0, update = 0;     ///< members that depend on it
  int orderMuch = 0;
  Errors length, tilt;  ///< of members with a certificate
  Verdict worst;
  std::vector<int> numbers;  ///< of members that fail anything but the comparison of orders
  int uncertified() const { return none + infeasible + left; }
};
void add(FamilyVerdict& family, const Verdict& verdict);

/// Members of a family: `count` from number `first` on.
struct MemberRange {
  std::uint32_t seed;
  int first, count;
  OverlapRange overlaps = kShallowOverlaps;
};

/// Each as judge() does.
FamilyVerdict judgeAll(const CertificateFamily& family, const MemberRange& range, const GeomChoices& choices);

}  // namespace otg::truth
