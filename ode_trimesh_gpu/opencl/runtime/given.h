// SPDX-License-Identifier: BSD-3-Clause
// Kernels that are given a structure of kernels/shared/layout/: see given.h there.
#pragma once

#include <string>
#include <utility>

#include "opencl/runtime/context.h"
#include "opencl/runtime/launch.h"
#include "shared/layout/given.h"

namespace otg::opencl {

/// The kernel that takes a `Given`.
template <class Given>
class KernelFor {
 public:
  /// Throws ClError.
  void make(Context& context, const std::string& program, const std::string& options) {
    kernel_ = context.makeKernel(program, options, Given::kName);
  }
  explicit operator bool() const { return static_cast<bool>(kernel_); }

  /// What the next launches are given. Throws ClError.
  void give(const Given& given) {
    kernel_.begin();
    cl_uint index = 0;
    giveAll(given, index);
  }
  /// For launch().
  operator const Kernel&() const { return kernel_; }

 private:
  template <class Structure>
  void giveAll(const Structure& structure, cl_uint& index) {
    structure.forEach([&](const auto& field) { giveOne(field, index); });
  }
  template <class T>
  void giveOne(const BufferOf<T>& buffer, cl_uint& index) {
    const cl_mem handle = buffer.get();
    kernel_.set(index++, sizeof handle, &handle);
  }
  template <class T>
  void giveOne(const LocalOf<T>& local, cl_uint& index) {
    kernel_.set(index++, local.bytes(), nullptr);
  }
  template <class T>
  void giveOne(const ValueOf<T>& value, cl_uint& index) {
    kernel_.set(index++, sizeof(T), &value.get());
  }
  template <class Part>
  void giveOne(const Part& part, cl_uint& index) {
    giveAll(part, index);
  }

  Kernel kernel_;
};

/// A DeviceList of elements of one type, `each` of them to an item.
template <class T>
class ListOf : public DeviceList {
 public:
  explicit ListOf(std::size_t each = 1) : DeviceList(each * sizeof(T)) {}
  BufferOf<T> buffer() const { return BufferOf<T>(get()); }
};

}  // namespace otg::opencl
