// SPDX-License-Identifier: BSD-3-Clause
// What a kernel is given, written once for both sides: as C++ it is a structure, as OpenCL C the kernel's parameters.
//
//     #define OTG_GIVEN_PairLevel(X, AND) (the backslashes are left out here)
//       X(value, otg_uint, level) AND
//       X(read, otg_node_pair, in) AND
//       X(write, otg_node_pair, out)
//     OTG_STRUCTURE(PairLevel, "pairLevel")
//
// OpenCL C:  __kernel void pairLevel(OTG_GIVEN(PairLevel)) { ... out[i] = in[i] ... }
// C++:       KernelFor<given::PairLevel> level; level.give({.level = 1, .in = from.buffer(), .out = to.buffer()});
//
// Buffers are parameters of their own, because OpenCL takes no pointers within a structure. On the host each of them is
// a field with a name and a type of elements: a buffer of other elements, another order, and a field that was forgotten
// do not compile.
//
// Kinds of fields:
//   value   the value itself
//   read    a buffer that the kernel only reads
//   write   a buffer that it writes, or reads and writes
//   alias   the same, and it may be the buffer of another field; aliasRead if the kernel only reads it
//   local   local memory, of a size that the host sets
//   part    another structure, made by OTG_PART, of fields that several kernels have
#ifndef OTG_SHARED_GIVEN_H
#define OTG_SHARED_GIVEN_H
#include "shared/math/platform.h"

#ifdef __OPENCL_VERSION__

#define OTG_GIVEN(name) OTG_GIVEN_##name(OTG_PARAMETER, OTG_COMMA)
#define OTG_STRUCTURE(name, kernel)
#define OTG_PART(name)

#define OTG_COMMA ,
#define OTG_PARAMETER(kind, type, name) OTG_PARAMETER_##kind(type, name)
#define OTG_PARAMETER_value(type, name) const type name
#define OTG_PARAMETER_read(type, name) __global const type* restrict name
#define OTG_PARAMETER_write(type, name) __global type* restrict name
#define OTG_PARAMETER_alias(type, name) __global type* name
#define OTG_PARAMETER_aliasRead(type, name) __global const type* name
#define OTG_PARAMETER_local(type, name) __local type* name
#define OTG_PARAMETER_part(type, name) OTG_GIVEN_##type(OTG_PART_PARAMETER, OTG_COMMA)
#define OTG_PART_PARAMETER(kind, type, name) OTG_PARAMETER_##kind(type, name)

/// Types of elements that are words, two words, bytes or doubles. The host distinguishes them.
#define OTG_WORD_ELEMENT(name) typedef uint name;
#define OTG_TWO_WORD_ELEMENT(name) typedef uint2 name;
#define OTG_BYTE_ELEMENT(name) typedef uchar name;
#define OTG_DOUBLE_ELEMENT(name) typedef double name;
/// 16 bytes of the buffer of all meshes.
typedef float4 otg_mesh_unit;

#else  // C++

#include <cstddef>
#include <type_traits>

struct _cl_mem;

namespace otg {

/// A buffer of a device, by the type of its elements: const if they are only read.
template <class T>
class BufferOf {
 public:
  explicit BufferOf(_cl_mem* buffer) : buffer_(buffer) {}
  /// What may be written may be read.
  template <class U>
  requires(std::is_const_v<T>&& std::is_same_v<const U, T>) BufferOf(BufferOf<U> other) : buffer_(other.get()) {}
  _cl_mem* get() const { return buffer_; }

 private:
  _cl_mem* buffer_;
};

/// Local memory for so many elements.
template <class T>
class LocalOf {
 public:
  LocalOf(std::size_t count) : bytes_(count * sizeof(T)) {}
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_;
};

/// A value that is not forgotten: there is no default.
template <class T>
class ValueOf {
 public:
  ValueOf(const T& value) : value_(value) {}
  const T& get() const { return value_; }

 private:
  T value_;
};

/// `kName`: the kernel's. forEach(f) calls f with one field after the other.
#define OTG_STRUCTURE(name, kernel)              \
  namespace given {                              \
  struct name {                                  \
    static constexpr const char* kName = kernel; \
    OTG_GIVEN_##name(OTG_FIELD, ;);              \
    template <class Visit>                       \
    void forEach(Visit&& visit) const {          \
      OTG_GIVEN_##name(OTG_VISIT, ;);            \
    }                                            \
  };                                             \
  }
#define OTG_PART(name) OTG_STRUCTURE(name, nullptr)

#define OTG_VISIT(kind, type, name) visit(name)
#define OTG_FIELD(kind, type, name) OTG_FIELD_##kind(type, name)
#define OTG_FIELD_value(type, name) ValueOf<type> name
#define OTG_FIELD_read(type, name) BufferOf<const type> name
#define OTG_FIELD_write(type, name) BufferOf<type> name
#define OTG_FIELD_alias(type, name) BufferOf<type> name
#define OTG_FIELD_aliasRead(type, name) BufferOf<const type> name
#define OTG_FIELD_local(type, name) LocalOf<type> name
#define OTG_FIELD_part(type, name) type name

#define OTG_WORD_ELEMENT(name) enum class name : otg_uint {};
#define OTG_TWO_WORD_ELEMENT(name) \
  struct name {                    \
    otg_uint x, y;                 \
  };
#define OTG_BYTE_ELEMENT(name) enum class name : unsigned char {};
#define OTG_DOUBLE_ELEMENT(name) \
  struct name {                  \
    double value;                \
  };
struct otg_mesh_unit {
  float x, y, z;
  otg_uint w;
};

}  // namespace otg

#endif

#endif  // OTG_SHARED_GIVEN_H
