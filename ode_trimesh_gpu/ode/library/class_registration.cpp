// SPDX-License-Identifier: BSD-3-Clause
// ODE has four user classes, forgets them in dCloseODE, and hands out the same numbers again after dInitODE2. No
// function of it reports any of this; registering too early is accepted and then wiped without a word. So the number
// that we keep is tested before it is trusted: ODE's collider table, which dInitODE2 clears, must lead to our function.
#include "ode/library/class_registration.h"

#include <ode/collision.h>
#include <ode/error.h>

#include <atomic>
#include <csetjmp>
#include <cstdarg>
#include <memory>
#include <mutex>

#include "base/fork_gate.h"
#include "dispatch/dispatcher.h"
#include "ode/base/environment_report.h"
#include "ode/base/status.h"
#include "ode/geom/class_number.h"
#include "ode/geom/geom_class.h"
#include "ode/pairs/mesh_collider.h"
#include "ode/shapes/primitive_collider.h"

namespace otg {
namespace {

struct Registry {
  std::mutex mutex;                                           ///< held while the table is probed or filled
  std::atomic<dMessageFunction*> outerDebugHandler{nullptr};  ///< while ours is in place: the program's
};

Registry& registry() {
  static Registry instance;
  return instance;
}

thread_local std::jmp_buf* debugTrap = nullptr;

/// ODE reports misuse by calling its debug handler and aborts if that returns. Ours jumps back out of the call that
/// this thread has made; no frame of ODE in between has anything to destroy. Other threads get the handler they had.
void onDebug(int number, const char* message, va_list arguments) {
  if (debugTrap != nullptr) std::longjmp(*debugTrap, 1);
  if (dMessageFunction* const outer = registry().outerDebugHandler.load()) outer(number, message, arguments);
}

class DebugHandlerScope {
 public:
  DebugHandlerScope() : before_(dGetDebugHandler()) {
    registry().outerDebugHandler = before_;
    dSetDebugHandler(&onDebug);
  }
  ~DebugHandlerScope() { dSetDebugHandler(before_); }
  DebugHandlerScope(const DebugHandlerScope&) = delete;
  DebugHandlerScope& operator=(const DebugHandlerScope&) = delete;

 private:
  dMessageFunction* before_;
};

/// Where onDebug jumps to. Built before setjmp, so that the jump skips no destructor.
struct DebugTrap {
  std::jmp_buf jump;
  DebugTrap() { debugTrap = &jump; }
  ~DebugTrap() { debugTrap = nullptr; }
  DebugTrap(const DebugTrap&) = delete;
  DebugTrap& operator=(const DebugTrap&) = delete;
};

/// ODE allocates in part with operator new, which may throw.
struct DestroyGeom {
  void operator()(dGeomID geom) const { dGeomDestroy(geom); }
};
struct DestroyHeights {
  void operator()(dHeightfieldDataID heights) const { dGeomHeightfieldDataDestroy(heights); }
};
using OwnedGeom = std::unique_ptr<dxGeom, DestroyGeom>;
using OwnedHeights = std::unique_ptr<dxHeightfieldData, DestroyHeights>;

/// dCollide for one contact; -1 where ODE would have aborted. The function has no locals that setjmp could spoil.
int tryCollide(dGeomID a, dGeomID b) {
  DebugTrap trap;
  volatile int count = -1;
  if (setjmp(trap.jump) == 0) {
    dContactGeom contact;
    count = dCollide(a, b, 1, &contact, sizeof(contact));
  }
  return count;
}

/// dCreateGeomClass; -1 where ODE would have aborted because there is no class left.
int tryCreateClass(const dGeomClass& record) {
  DebugTrap trap;
  volatile int number = -1;
  if (setjmp(trap.jump) == 0) number = dCreateGeomClass(&record);
  return number;
}

/// A ray that hits a plane gives one contact exactly if ODE's own colliders are in place; builds of ODE with assertions
/// stop before that, builds without find an empty table.
bool odeIsInitialized() {
  const OwnedGeom ray(dCreateRay(nullptr, 2));
  dGeomRaySet(ray.get(), 0, 0, 1, 0, 0, -1);
  const OwnedGeom plane(dCreatePlane(nullptr, 0, 0, 1, 0));
  return tryCollide(ray.get(), plane.get()) == 1;
}

bool collidesThroughUs(dGeomID probe, dGeomID other) {
  takeProbeAnswer();
  tryCollide(probe, other);
  return takeProbeAnswer();
}

/// Whether ODE's table leads from this class to our functions. Two entries are tried, in case the program has put a
/// function of its own into one. Heightfield and convex are what another library's class, should it own the number by
/// now, is least likely to have a collider for.
bool classIsOurs(int number) {
  const OwnedGeom probe(dCreateGeom(number));
  const OwnedHeights heights(dGeomHeightfieldDataCreate());
  const OwnedGeom field(dCreateHeightfield(nullptr, heights.get(), 1));
  if (collidesThroughUs(probe.get(), field.get())) return true;
  static const dReal kPlane[4] = {0, 0, 1, 0};
  static const dReal kPoint[3] = {0, 0, 0};
  static const unsigned int kPolygons[1] = {0};
  const OwnedGeom convex(dCreateConvex(nullptr, kPlane, 0, kPoint, 0, kPolygons));
  return collidesThroughUs(probe.get(), convex.get());
}

/// ODE calls once for each pair of classes and keeps the result, NULL ("never any contacts") included. A class that is
/// called with a number that it doesn't know must return NULL, or the other class is never called.
dColliderFn* colliderFor(int otherClass) {
  if (otherClass == registeredClass()) return &collideMeshMesh;
  return otherClass >= dSphereClass && otherClass < dFirstSpaceClass ? &collideMeshPrimitive : nullptr;
}

int registerClass() {
  dGeomClass record{};
  record.bytes = sizeof(GeomObject*);  // NOLINT(bugprone-sizeof-expression): ODE keeps the pointer
  record.collider = &colliderFor;
  record.aabb = &computeAabb;
  record.dtor = &destroyObject;
  const int number = tryCreateClass(record);
  if (number < 0) return dGPUTRIMESH_ERROR_CLASS_COUNT;
  setRegisteredClass(number);
  // ODE would fill these entries on the first collision of each pair, without a lock. Spaces and dGeomTransform have
  // theirs already; other user classes may come later and are left to ODE.
  for (int other = dSphereClass; other < dFirstSpaceClass; ++other) {
    if (other != dGeomTransformClass) dSetColliderOverride(number, other, &collideMeshPrimitive);
  }
  dSetColliderOverride(number, number, &collideMeshMesh);
  return dGPUTRIMESH_OK;
}

void chooseBackendOnce() {
  static std::once_flag chosen;
  watchEndOfProcess();
  reportEnvironment();
  std::call_once(chosen, [] { chooseBackendOfEnvironment(); });
}

}  // namespace

int precisionStatus(ConfigurationCheck check) noexcept {
#if defined(dDOUBLE)
  const char* const own = "ODE_double_precision";
  const char* const other = "ODE_single_precision";
#else
  const char* const own = "ODE_single_precision";
  const char* const other = "ODE_double_precision";
#endif
  return check(own) != 0 && check(other) == 0 ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_PRECISION;
}

int checkOde() noexcept {
  const int result = guarded([] {
    if (const int status = precisionStatus(&dCheckConfiguration)) return status;
    const CallLock lock(registry().mutex);
    const DebugHandlerScope scope;
    return static_cast<int>(odeIsInitialized() ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_ODE);
  });
  if (result == dGPUTRIMESH_OK) chooseBackendOnce();
  return result;
}

int ensureRegistered() noexcept {
  const int result = guarded([] {
    if (const int status = precisionStatus(&dCheckConfiguration)) return status;
    const CallLock lock(registry().mutex);
    const DebugHandlerScope scope;
    if (!odeIsInitialized()) return static_cast<int>(dGPUTRIMESH_ERROR_ODE);
    const int known = registeredClass();
    if (known >= 0 && classIsOurs(known)) return static_cast<int>(dGPUTRIMESH_OK);
    return registerClass();
  });
  if (result == dGPUTRIMESH_OK) chooseBackendOnce();
  return result;
}

}  // namespace otg
