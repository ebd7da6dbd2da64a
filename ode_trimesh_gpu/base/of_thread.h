// SPDX-License-Identifier: BSD-3-Clause
// One object for each thread.
#pragma once

#ifdef __MINGW32__
#include <pthread.h>

#include <exception>
#endif

namespace otg {

#ifdef __MINGW32__
/// Each thread's object of one type. GCC for Windows frees the memory of a thread_local object before it calls the
/// destructor (GCC bug 83562). So a key of POSIX threads keeps it.
template <class T>
class ThreadObjects {
 public:
  ThreadObjects() noexcept {
    hasKey_ = pthread_key_create(&key_, [](void* o) { delete static_cast<T*>(o); }) == 0;
  }
  /// Threads may outlive a library that is unloaded. Their ends must not call what is no longer there.
  ~ThreadObjects() {
    if (hasKey_) pthread_key_delete(key_);
    hasKey_ = false;
  }
  ThreadObjects(const ThreadObjects&) = delete;
  ThreadObjects& operator=(const ThreadObjects&) = delete;

  T& ofThisThread() const noexcept {
    // Without a key, as in destructors of a program's globals, the object stays until the process ends.
    thread_local T* kept = nullptr;
    if (!hasKey_) return kept != nullptr ? *kept : *(kept = new T);
    if (void* const object = pthread_getspecific(key_); object != nullptr) return *static_cast<T*>(object);
    auto* const made = new T;
    if (pthread_setspecific(key_, made) != 0) std::terminate();
    return *made;
  }

 private:
  // Outside of the object: they are read after its destructor, too.
  static inline pthread_key_t key_{};
  static inline bool hasKey_ = false;
};
#endif

/// The calling thread's object: made at the thread's first call, destroyed when the thread ends. Without memory for it
/// the program ends: that is what every compiler's thread_local does.
template <class T>
T& ofThread() noexcept {
#ifdef __MINGW32__
  static const ThreadObjects<T> objects;
  return objects.ofThisThread();
#else
  thread_local T object;
  return object;
#endif
}

}  // namespace otg
