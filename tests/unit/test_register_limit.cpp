// SPDX-License-Identifier: BSD-3-Clause
// A limit of registers in the text of programs, without a device.
#include <string>

#include "opencl/runtime/register_limit.h"
#include "support/catch.h"

using namespace otg::opencl;

namespace {

Bytes bytesOf(const std::string& text) {
  return {text.begin(), text.end()};
}

std::string limited(const std::string& text, unsigned registers) {
  const std::optional<Bytes> bytes = withRegisterLimit(bytesOf(text), registers);
  return bytes ? std::string(bytes->begin(), bytes->end()) : "none";
}

}  // namespace

TEST_CASE("the limit of registers is read from a program's options") {
  CHECK(registerLimitOf("-DOTG_GROUP=32 -cl-nv-maxrregcount=96 -DX") == 96);
  CHECK(registerLimitOf("-DOTG_GROUP=32") == 0);
}

TEST_CASE("every kernel of a program gets the limit, and nothing else changes") {
  const std::string first = ".version 8.0\n.func f() { ret; }\n.entry a(.param .u64 p)\n.reqntid 32, 1, 1\n";
  const std::string second = "{ { ret; } }\n.visible .entry b(.param .u64 p)\n", end = "{ ret; }\n";
  CHECK(limited(first + second + end, 96) == first + ".maxnreg 96\n" + second + ".maxnreg 96\n" + end);
}

TEST_CASE("what is no text of PTX, or has a limit, stays as it is") {
  CHECK(limited("\x7f"
                "ELF .entry a { ret; }",
                96) == "none");
  CHECK(limited(".version 8.0\n.func f() { ret; }", 96) == "none");
  CHECK(limited(".version 8.0\n.entry a() .maxnreg 64 { ret; }", 96) == "none");
  CHECK(limited(".version 8.0\n.entry a() { ret; }", 0) == "none");
}
