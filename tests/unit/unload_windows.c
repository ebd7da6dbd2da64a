/* SPDX-License-Identifier: BSD-3-Clause */
/* Windows: threads that have called the library end after it was unloaded. The argument is the library. */
#include <pthread.h>
#include <stdio.h>
#include <windows.h>

static HMODULE library;
static HANDLE called, unloaded;

typedef void* (*Create)(void);
typedef void (*Destroy)(void*);

static void* work(void* unused) {
  Create create = (Create)(void (*)(void))GetProcAddress(library, "dGpuTriMeshDataCreate");
  Destroy destroy = (Destroy)(void (*)(void))GetProcAddress(library, "dGpuTriMeshDataDestroy");
  if (create == NULL || destroy == NULL) return "has not the functions";
  destroy(create());
  SetEvent(called);
  WaitForSingleObject(unloaded, INFINITE);
  return unused;
}

static const char* loadAndUnload(const char* path) {
  pthread_t thread;
  void* fault = NULL;
  called = CreateEventA(NULL, FALSE, FALSE, NULL);
  unloaded = CreateEventA(NULL, FALSE, FALSE, NULL);
  library = LoadLibraryA(path);
  if (library == NULL) return "is not loaded";
  if (pthread_create(&thread, NULL, work, NULL) != 0) return "has no thread";
  WaitForSingleObject(called, 10000);
  FreeLibrary(library);
  if (GetModuleHandleA("libode_trimesh_gpu.dll") != NULL) return "stays loaded";
  SetEvent(unloaded);
  pthread_join(thread, &fault);
  CloseHandle(called);
  CloseHandle(unloaded);
  return fault;
}

int main(int argc, char** argv) {
  int round;
  for (round = 0; round < 10; ++round) {
    const char* fault = argc == 2 ? loadAndUnload(argv[1]) : "is not named";
    if (fault == NULL) continue;
    printf("the library %s (error %lu)\n", fault, (unsigned long)GetLastError());
    return 1;
  }
  return 0;
}
