// SPDX-License-Identifier: BSD-3-Clause
#include "truth/certificate_verdict.h"

#include <cmath>

#include "truth/separation_search.h"

namespace otg::truth {
namespace {

/// In units of the smaller body.
constexpr double kSamePlace = 1e-9;

double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}

}  // namespace

double Verdict::badness() const {
  if (certificate.none) return 4e9;
  if (certificate.infeasible) return 3e9;
  if (certificate.left > kMostLeft) return 1e9 * (1 + certificate.left);
  return length;
}

Verdict judge(const CertificateMember& member, int number, int places) {
  Verdict verdict;
  verdict.number = number;
  const GeomChoices choices{.places = places};
  const std::vector<JudgedContact> contacts = contactsInOde(member.a, member.b, choices);
  const auto other = [&](bool GeomChoices::* choice) {
    GeomChoices changed = choices;
    changed.*choice = true;
    return unmatched(contacts, contactsInOde(member.a, member.b, changed), kSamePlace * member.size) > 0;
  };
  verdict.contacts = static_cast<int>(contacts.size());
  verdict.orderMatters = other(&GeomChoices::secondFirst);
  verdict.callMatters = other(&GeomChoices::reversedCall);
  verdict.updateMatters = other(&GeomChoices::byUpdate);
  verdict.tooDeep = static_cast<int>(tooDeep(member.plainA, member.plainB, contacts, member.grain()).size());
  const auto oracle = makeOracle(member.a, member.b, member.grain());
  verdict.certificate = certify(*oracle, contacts);
  if (!verdict.certified()) return verdict;
  const auto plain = makeOracle(member.plainA, member.plainB, member.grain());
  const Vec3d shortest = shorterSeparation(*plain, member.shortest, verdict.certificate.asked);
  verdict.length = verdict.certificate.length / norm(shortest);
  verdict.tilt = angleBetween(verdict.certificate.asked, shortest);
  return verdict;
}

void add(FamilyVerdict& family, const Verdict& verdict) {
  ++family.members;
  const Certificate& certificate = verdict.certificate;
  family.none += certificate.none;
  family.infeasible += certificate.infeasible;
  if (!certificate.none && !certificate.infeasible && !verdict.certified()) ++family.left;
  family.tooDeep += verdict.tooDeep > 0;
  family.order += verdict.orderMatters;
  family.call += verdict.callMatters;
  family.update += verdict.updateMatters;
  if (verdict.certified()) {
    family.length.add(verdict.length);
    family.tilt.add(verdict.tilt);
    family.tooLong += verdict.length > kMostLength;
  }
  if (!verdict.certified() || verdict.length > kMostLength || verdict.tooDeep > 0) {
    family.numbers.push_back(verdict.number);
  }
  if (family.members == 1 || verdict.badness() > family.worst.badness()) family.worst = verdict;
}

}  // namespace otg::truth
