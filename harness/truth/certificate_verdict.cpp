// SPDX-License-Identifier: BSD-3-Clause
#include "truth/certificate_verdict.h"

#include <cmath>

#include "truth/separation_search.h"

namespace otg::truth {
namespace {

/// Places and depths in units of the smaller body, and normals.
constexpr double kSame = 1e-9, kNearlySame = 1e-3;

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

Verdict judge(const CertificateMember& member, int number, const GeomChoices& choices) {
  Verdict verdict;
  verdict.number = number;
  const std::vector<JudgedContact> contacts = contactsInOde(member.a, member.b, choices);
  const auto differ = [&](bool GeomChoices::*choice, double tolerance) {
    GeomChoices changed = choices;
    changed.*choice = true;
    return unmatched(contacts, contactsInOde(member.a, member.b, changed), tolerance * member.size, tolerance) > 0;
  };
  verdict.contacts = static_cast<int>(contacts.size());
  verdict.orderMatters = differ(&GeomChoices::secondFirst, kSame);
  verdict.orderMuch = verdict.orderMatters && differ(&GeomChoices::secondFirst, kNearlySame);
  verdict.callMatters = differ(&GeomChoices::reversedCall, kSame);
  verdict.updateMatters = differ(&GeomChoices::byUpdate, kSame);
  verdict.tooDeep = static_cast<int>(tooDeep(member.plainA, member.plainB, contacts, member.grain()).size());
  const auto oracle = makeOracle(member.a, member.b, member.grain());
  verdict.certificate = certify(*oracle, norm(member.shortest), contacts);
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
  family.leftWay += !certificate.none && !certificate.infeasible && certificate.leftWay > kMostLeft;
  family.tooDeep += verdict.tooDeep > 0;
  family.order += verdict.orderMatters;
  family.orderMuch += verdict.orderMuch;
  family.call += verdict.callMatters;
  family.update += verdict.updateMatters;
  if (verdict.certified()) {
    family.length.add(verdict.length);
    family.tilt.add(verdict.tilt);
    family.tooLong += verdict.length > kMostLength;
    family.longer += verdict.length > kGoodLength;
  }
  if (!verdict.certified() || verdict.length > kMostLength || verdict.tooDeep > 0) {
    family.numbers.push_back(verdict.number);
  }
  if (family.members == 1 || verdict.badness() > family.worst.badness()) family.worst = verdict;
}

FamilyVerdict judgeAll(const CertificateFamily& family, const MemberRange& range, const GeomChoices& choices) {
  FamilyVerdict verdict;
  for (int i = range.first; i < range.first + range.count; ++i) {
    const std::optional<CertificateMember> member = certificateMember(family, range.seed, i, range.overlaps);
    if (!member) {
      ++verdict.notDrawn;
      continue;
    }
    add(verdict, judge(*member, i, choices));
  }
  return verdict;
}

}  // namespace otg::truth
