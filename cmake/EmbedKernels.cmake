# SPDX-License-Identifier: BSD-3-Clause
# Script: writes OUTPUT, a C++ source with the text of every file of KERNELS (paths below FOLDER, separated by "|").
string(REPLACE "|" ";" files "${KERNELS}")
set(source "// Made by cmake/EmbedKernels.cmake from kernels/.\n#include \"opencl/runtime/kernel_source.h\"\n\nnamespace otg::opencl {\n")
string(APPEND source "const KernelFile kKernelFiles[] = {\n")
foreach(file IN LISTS files)
  file(READ "${FOLDER}/${file}" text)
  string(APPEND source "    {\"${file}\", R\"otg_kernel(${text})otg_kernel\"},\n")
endforeach()
list(LENGTH files count)
string(APPEND source "};\nconst unsigned kKernelFileCount = ${count};\n}  // namespace otg::opencl\n")
file(WRITE "${OUTPUT}" "${source}")
