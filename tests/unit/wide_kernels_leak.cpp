// SPDX-License-Identifier: BSD-3-Clause
// What a file of SIMD kernels must not do, for the test of the test that looks for it (simd_symbols.sh): leave a copy
// of an inline function that other files could use too.
namespace otg {

[[gnu::noinline]] inline int leaked(int x) {
  return x + 1;
}

namespace simd_leak {
[[gnu::noinline]] inline int own(int x) {
  return x + 2;
}
int kernel(int x);
int kernel(int x) {
  return leaked(x) + own(x);
}
}  // namespace simd_leak

}  // namespace otg
