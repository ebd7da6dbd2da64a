// SPDX-License-Identifier: BSD-3-Clause
// A reader of mesh files (OTG_FUZZ_READER) and what is built of what it reads.
#include <stdexcept>

#include "fuzz/fuzz_target.h"
#include "mesh_io/readers.h"

using namespace otg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const mesh_io::MeshFile file = mesh_io::OTG_FUZZ_READER({reinterpret_cast<const char*>(data), size});
    const MeshResult built = buildTriMesh(file.input(), RepairOptions::all());
    fuzz::require((built.mesh == nullptr) == !built.report.error.empty());
  } catch (const std::runtime_error&) {  // what readers refuse
  }
  return 0;
}

std::vector<fuzz::Input> fuzz::seeds() {
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", faces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const std::string plyHead =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  // Two bodies that are 1e30 times as long as wide.
  std::string needles;
  for (const std::string x : {"0", "2"})
    needles += "v " + x + " 0 0\nv " + x + ".5 1 0\nv " + x + ".9 0 0\nv " + x + ".5 0 1e30\n" +
               "f -4 -3 -2\nf -4 -1 -3\nf -3 -1 -2\nf -2 -1 -4\n";
  std::string stl(80, ' ');
  stl += std::string("\1\0\0\0", 4) + std::string(50, '\0');
  return {inputOf("ply\nformat ascii 1.0\n" + plyHead + vertices + faces),
          inputOf("ply\nformat binary_little_endian 1.0\n" + plyHead + std::string(100, '\1')),
          inputOf("ply\nformat ascii 1.0\nelement nothing 9\n" + plyHead + vertices + faces),
          inputOf("OFF\n4 4 6\n" + vertices + faces),
          inputOf("COFF\n3 1 0\n0 0 0 1 1 1\n1 0 0\n0 1 0\n3 0 1 2\n"),
          inputOf("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1/1 2//2 4/4/4\nf -4 -1 -2\nf 2 3 4\n"),
          inputOf(needles),
          inputOf("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
                  "endfacet\nendsolid a\n"),
          inputOf(stl)};
}
