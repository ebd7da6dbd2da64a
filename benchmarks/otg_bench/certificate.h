// SPDX-License-Identifier: BSD-3-Clause
// `otg bench contacts --certificate`: what sets of contacts request, in families of random pairs; and these as worlds.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "otg_bench/scene.h"

namespace otg::cli {

struct CertificateOptions {
  int members = 50;               ///< of each family
  int first = 0;                  ///< number of the first
  bool deep = false;              ///< overlaps are drawn from truth::kDeepOverlaps
  std::string family;             ///< only this one; empty: all
  std::vector<BenchMesh> meshes;  ///< of closed bodies; a family for each of them, instead of the others
  int member = -1;                ///< instead of a table: all of this one
  int places = 64;
  std::string form = "own";  ///< own: the library's geoms; override, stock: dTriMesh with and without the library
  std::uint32_t seed = 1;
  bool falls = false;             ///< instead of single queries: the pairs stepped, beside stock dTriMesh
  bool open = false;              ///< of the worlds: hosts without the triangles in the sides of their bounding boxes
  std::string start = "settled";  ///< of the worlds: how movers begin: settled, dropped or slid
  double seconds = 2;             ///< of the worlds
  int rate = 0;                   ///< of the worlds: steps a second; 0: 60 and 240 in turn
  bool json = false;
};

int benchCertificate(const CertificateOptions& options);

}  // namespace otg::cli
