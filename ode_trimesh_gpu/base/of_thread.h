// SPDX-License-Identifier: BSD-3-Clause
// One object for each thread.
#pragma once

#ifdef __MINGW32__
#include <pthread.h>

#include <new>
#endif

namespace otg {

/// The calling thread's object: made at the thread's first call, destroyed when the thread ends.
template <class T>
T& ofThread() {
#ifdef __MINGW32__
  // GCC for Windows frees the memory of a thread_local object before it calls the destructor (GCC bug 83562).
  static const pthread_key_t key = [] {
    pthread_key_t made;
    if (pthread_key_create(&made, [](void* object) { delete static_cast<T*>(object); }) != 0) throw std::bad_alloc();
    return made;
  }();
  auto* object = static_cast<T*>(pthread_getspecific(key));
  if (object == nullptr) {
    object = new T;
    if (pthread_setspecific(key, object) != 0) {
      delete object;
      throw std::bad_alloc();
    }
  }
  return *object;
#else
  thread_local T object;
  return object;
#endif
}

}  // namespace otg
