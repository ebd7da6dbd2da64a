// SPDX-License-Identifier: BSD-3-Clause
// Registration with ODE: too early, twice, after ODE was closed, beside other classes, with the wrong precision.
#include <cstring>

#include "ode/library/class_registration.h"
#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

/// Another library's class. Its functions fail the test if they are ever handed a geom that is not theirs.
int foreignClass = -1;
int foreignCollisions = 0;

int collideForeign(dGeomID o1, dGeomID, int, dContactGeom*, int) {
  if (dGeomGetClass(o1) == foreignClass) ++foreignCollisions;
  return 0;
}
dColliderFn* foreignColliderFor(int other) {
  return other == foreignClass ? &collideForeign : nullptr;
}
void foreignAabb(dGeomID, dReal aabb[6]) {
  for (int i = 0; i < 6; ++i) aabb[i] = i % 2;
}

int registerForeign() {
  dGeomClass record{};
  record.bytes = 64;
  record.collider = &foreignColliderFor;
  record.aabb = &foreignAabb;
  foreignClass = dCreateGeomClass(&record);
  return foreignClass;
}

void startOde() {
  dInitODE2(0);
  dAllocateODEDataForThread(dAllocateMaskAll);
}

/// Two overlapping boxes collide: the class is alive in the ODE that runs now.
std::size_t overlapContacts() {
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom a(box), b(box);
  if (a.id == nullptr || b.id == nullptr) return 0;
  dGeomSetPosition(b.id, 0.3, 0.2, 0.9);
  return test::collide(a.id, b.id).size();
}

}  // namespace

TEST_CASE("before dInitODE2 the library says so, and works as soon as ODE does") {
  CHECK(dGpuTriMeshInit() == 0);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_ODE);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_OK);  // reading it resets it
  CHECK(dCreateGpuTriMesh(nullptr, nullptr) == nullptr);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_ODE);
  CHECK(dGetDebugHandler() == nullptr);
  startOde();
  CHECK(overlapContacts() > 0);  // without another dGpuTriMeshInit
  dCloseODE();
}

TEST_CASE("initialising again is harmless and takes no second class") {
  startOde();
  REQUIRE(dGpuTriMeshInit() == 1);
  const int number = dGpuTriMeshGetClass();
  CHECK(number >= dFirstUserClass);
  for (int i = 0; i < 20; ++i) {
    CHECK(dGpuTriMeshInit() == 1);
    dGpuTriMeshClose();
  }
  CHECK(dGpuTriMeshInit() == 1);
  CHECK(dGpuTriMeshGetClass() == number);
  CHECK(overlapContacts() > 0);
  dCloseODE();
}

TEST_CASE("the class survives closing and starting ODE, with or without dGpuTriMeshInit()") {
  for (const bool explicitly : {true, false, true}) {
    startOde();
    if (explicitly) CHECK(dGpuTriMeshInit() == 1);
    CHECK(overlapContacts() > 0);
    if (explicitly) dGpuTriMeshClose();
    dCloseODE();
    if (!explicitly) CHECK(dCreateGpuTriMesh(nullptr, nullptr) == nullptr);
  }
}

TEST_CASE("our number is not mistaken for our class when another library has it after a restart") {
  startOde();
  REQUIRE(dGpuTriMeshInit() == 1);
  const int before = dGpuTriMeshGetClass();
  dCloseODE();
  startOde();
  REQUIRE(registerForeign() == before);
  REQUIRE(dGpuTriMeshInit() == 1);
  CHECK(dGpuTriMeshGetClass() != before);
  CHECK(overlapContacts() > 0);
  dCloseODE();
}

TEST_CASE("two libraries' classes live side by side in both orders of registration") {
  for (const bool oursFirst : {true, false}) {
    startOde();
    if (oursFirst) REQUIRE(dGpuTriMeshInit() == 1);
    registerForeign();
    REQUIRE(dGpuTriMeshInit() == 1);
    CHECK(overlapContacts() > 0);
    {
      const Data box(scenes::makeBox({1, 1, 1}));
      const Geom ours(box);
      const dGeomID f1 = dCreateGeom(foreignClass), f2 = dCreateGeom(foreignClass);
      dContactGeom contact;
      foreignCollisions = 0;
      CHECK(dCollide(f1, f2, 1, &contact, sizeof(contact)) == 0);
      CHECK(foreignCollisions == 1);
      for (int round = 0; round < 2; ++round) {
        CHECK(dCollide(ours.id, f1, 1, &contact, sizeof(contact)) == 0);
        CHECK(dCollide(f1, ours.id, 1, &contact, sizeof(contact)) == 0);
      }
      CHECK(foreignCollisions == 1);
      // Functions of ours refuse a geom of theirs.
      CHECK(dGeomGpuTriMeshGetTriangleCount(f1) == 0);
      CHECK(dGeomGpuTriMeshSetData(f1, box.id) == dGPUTRIMESH_ERROR_CLASS);
      dGeomDestroy(f1);
      dGeomDestroy(f2);
    }
    CHECK(overlapContacts() > 0);
    dCloseODE();
  }
}

TEST_CASE("when ODE has no class left, that is an error and not an abort") {
  startOde();
  for (int i = 0; i < dMaxUserClasses; ++i) registerForeign();
  CHECK(dGpuTriMeshInit() == 0);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_CLASS_COUNT);
  CHECK(dCreateGpuTriMesh(nullptr, nullptr) == nullptr);
  dCloseODE();
  startOde();
  CHECK(overlapContacts() > 0);
  dCloseODE();
}

TEST_CASE("a program's own collider for this class does not make the class look lost") {
  startOde();
  REQUIRE(dGpuTriMeshInit() == 1);
  const int number = dGpuTriMeshGetClass();
  dSetColliderOverride(number, dHeightfieldClass, &collideForeign);
  CHECK(dGpuTriMeshInit() == 1);
  CHECK(dGpuTriMeshGetClass() == number);
  CHECK(overlapContacts() > 0);
  dCloseODE();
}

TEST_CASE("the program's debug handler stays in place") {
  startOde();
  dMessageFunction* const handler = [](int, const char*, va_list) {};
  dSetDebugHandler(handler);
  CHECK(dGpuTriMeshInit() == 1);
  CHECK(dGetDebugHandler() == handler);
  dSetDebugHandler(nullptr);
  dCloseODE();
}

TEST_CASE("an ODE of the other precision is refused") {
  constexpr bool isDouble = sizeof(dReal) == 8;
  CHECK(precisionStatus(&dCheckConfiguration) == dGPUTRIMESH_OK);
  const auto ofDouble = [](const char* token) { return std::strcmp(token, "ODE_double_precision") == 0 ? 1 : 0; };
  const auto ofSingle = [](const char* token) { return std::strcmp(token, "ODE_single_precision") == 0 ? 1 : 0; };
  CHECK(precisionStatus(ofDouble) == (isDouble ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_PRECISION));
  CHECK(precisionStatus(ofSingle) == (isDouble ? dGPUTRIMESH_ERROR_PRECISION : dGPUTRIMESH_OK));
  CHECK(precisionStatus([](const char*) { return 0; }) == dGPUTRIMESH_ERROR_PRECISION);
  CHECK(dGpuTriMeshCheckConfiguration(isDouble ? "double_precision" : "single_precision") == 1);
  CHECK(dGpuTriMeshCheckConfiguration(isDouble ? "single_precision" : "double_precision") == 0);
  CHECK(dGpuTriMeshCheckConfiguration("ode_trimesh_gpu") == 1);
  CHECK(dGpuTriMeshCheckConfiguration("ode_trimesh") == 0);
  CHECK(dGpuTriMeshCheckConfiguration("") == 0);
  CHECK(dGpuTriMeshCheckConfiguration(nullptr) == 0);
}

TEST_CASE("every status has a sentence of its own") {
  std::vector<std::string> seen;
  for (int status = dGPUTRIMESH_ERROR_BUSY - 1; status <= dGPUTRIMESH_OPENING; ++status) {
    const std::string text = dGpuTriMeshErrorString(status);
    CHECK(!text.empty());
    CHECK(std::find(seen.begin(), seen.end(), text) == seen.end());
    seen.push_back(text);
  }
}
