// SPDX-License-Identifier: BSD-3-Clause
// Environment variables: what is allowed is taken, and what is not has a sentence that says what would be.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/environment.h"
#include "support/catch.h"
#include "support/environment_variable.h"

using otg::Environment;

namespace {

/// Set as long as the object lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) { otg::test::setVariable(name, value.c_str()); }
  ~Variable() { otg::test::unsetVariable(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

Environment with(const char* name, const std::string& value) {
  const Variable variable(name, value);
  return otg::readEnvironment();
}

/// Without the variables of whoever runs the tests.
void clear() {
  for (const char* name :
       {"OTG_BACKEND", "OTG_DEVICE_MEMORY", "OTG_THREADS", "OTG_OPENCL_DEVICE", "OTG_CACHE_DIR", "OTG_KERNEL_DIR",
        "OTG_MESH_DIR", "OTG_PRELOAD", "OTG_PRELOAD_JOIN", "OTG_PRELOAD_VERBOSE", "OTG_PRELOAD_CONTACTS",
        "OTG_PRELOAD_MAX_CONTACTS", "OTG_PRELOAD_CONTACTS_PER_REGION", "OTG_PRELOAD_PRIMITIVES"}) {
    otg::test::unsetVariable(name);
  }
}

}  // namespace

TEST_CASE("nothing set is nothing wrong") {
  clear();
  const Environment e = otg::readEnvironment();
  CHECK(e.faults.empty());
  CHECK(!e.backend);
  CHECK(!e.threads);
  CHECK(!e.deviceMemory);
  CHECK(e.preload);
  CHECK(e.preloadJoin);
  CHECK(!e.preloadVerbose);
  CHECK(e.preloadPrimitives.empty());
}

TEST_CASE("switches know more than one word, in any letters") {
  clear();
  for (const char* off : {"0", "off", "no", "false", "OFF", "No", "False"}) {
    INFO(off);
    CHECK(!with("OTG_PRELOAD", off).preload);
    CHECK(!with("OTG_PRELOAD_JOIN", off).preloadJoin);
    CHECK(!with("OTG_PRELOAD_VERBOSE", off).preloadVerbose);
    CHECK(with("OTG_PRELOAD", off).faults.empty());
  }
  for (const char* on : {"1", "on", "yes", "true", "On", "TRUE"}) {
    INFO(on);
    CHECK(with("OTG_PRELOAD", on).preload);
    CHECK(with("OTG_PRELOAD_VERBOSE", on).preloadVerbose);
    CHECK(with("OTG_PRELOAD_VERBOSE", on).faults.empty());
  }
  CHECK(with("OTG_PRELOAD", "").faults.empty());
  CHECK(with("OTG_PRELOAD", "").preload);
}

TEST_CASE("values that are allowed are taken") {
  clear();
  CHECK(with("OTG_BACKEND", "cpu").backend == Environment::Backend::kCpu);
  CHECK(with("OTG_BACKEND", "opencl").backend == Environment::Backend::kOpencl);
  CHECK(with("OTG_BACKEND", "auto").backend == Environment::Backend::kAuto);
  CHECK(with("OTG_THREADS", "7").threads == 7u);
  CHECK(with("OTG_DEVICE_MEMORY", "123456789012").deviceMemory == 123456789012u);
  CHECK(with("OTG_PRELOAD_CONTACTS", "pairwise").preloadContacts == Environment::Contacts::kPairwise);
  CHECK(with("OTG_PRELOAD_MAX_CONTACTS", "65535").preloadMaxContacts == 65535);
  CHECK(with("OTG_PRELOAD_CONTACTS_PER_REGION", "64").preloadContactsPerRegion == 64);
  CHECK(with("OTG_PRELOAD_PRIMITIVES", "box,,ray,all").preloadPrimitives ==
        std::vector<std::string>{"box", "ray", "all"});
#ifndef _WIN32  // where a variable that is empty is one that is not set
  CHECK(with("OTG_CACHE_DIR", "").cacheFolder == std::string());
#endif
  CHECK(with("OTG_KERNEL_DIR", "/").kernelFolder == "/");
}

TEST_CASE("each value that is not allowed has one sentence, and counts as not set") {
  clear();
  const std::string file = (std::filesystem::temp_directory_path() / "otg_test_environment").string();
  std::ofstream(file) << "no folder";
  const struct {
    const char* name;
    std::string value;
    const char* allowed;
  } kWrong[] = {{"OTG_BACKEND", "cuda", "auto, cpu, opencl"},
                {"OTG_BACKEND", "CPU", "auto, cpu, opencl"},
                {"OTG_DEVICE_MEMORY", "abc", "bytes"},
                {"OTG_DEVICE_MEMORY", "-1", "bytes"},
                {"OTG_DEVICE_MEMORY", "1e9", "bytes"},
                {"OTG_DEVICE_MEMORY", "99999999999999999999999", "bytes"},
                {"OTG_THREADS", "0", "1 to 1024"},
                {"OTG_THREADS", "1025", "1 to 1024"},
                {"OTG_THREADS", "4 ", "1 to 1024"},
                {"OTG_KERNEL_DIR", "/no/such/folder", "folder"},
                {"OTG_MESH_DIR", "/no/such/folder", "folder"},
                {"OTG_CACHE_DIR", file, "folder"},
                {"OTG_PRELOAD", "maybe", "off"},
                {"OTG_PRELOAD_JOIN", "2", "off"},
                {"OTG_PRELOAD_VERBOSE", "-", "off"},
                {"OTG_PRELOAD_CONTACTS", "bogus", "solid, pairwise"},
                {"OTG_PRELOAD_MAX_CONTACTS", "-4", "1 to 65535"},
                {"OTG_PRELOAD_MAX_CONTACTS", "65536", "1 to 65535"},
                {"OTG_PRELOAD_CONTACTS_PER_REGION", "0", "1 to 64"},
                {"OTG_PRELOAD_PRIMITIVES", "box,cone", "heightfield"}};
  for (const auto& wrong : kWrong) {
    INFO(wrong.name << "=" << wrong.value);
    const Environment e = with(wrong.name, wrong.value);
    REQUIRE(e.faults.size() == 1);
    CHECK(e.faults[0].find(wrong.name) == 0);
    CHECK(e.faults[0].find(wrong.allowed) != std::string::npos);
    CHECK(e.faults[0].find('\n') == std::string::npos);
    CHECK(!e.backend);
    CHECK(!e.threads);
    CHECK(!e.deviceMemory);
    CHECK(!e.preloadContacts);
    CHECK(!e.preloadMaxContacts);
    CHECK(e.preload);
    CHECK(e.preloadJoin);
  }
  std::filesystem::remove(file);
  const Environment two = [] {
    const Variable backend("OTG_BACKEND", "x\ny"), primitives("OTG_PRELOAD_PRIMITIVES", "cone,box,pyramid");
    return otg::readEnvironment();
  }();
  CHECK(two.faults.size() == 3);
  CHECK(two.preloadPrimitives == std::vector<std::string>{"box"});
}
