// SPDX-License-Identifier: BSD-3-Clause
// NumPy arrays in and out. Arrays that come in are contiguous: the Python side sees to that.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace otg::python {

namespace nb = nanobind;

template <class T, class... Shape>
using InputArray = nb::ndarray<const T, Shape..., nb::c_contig, nb::device::cpu>;
using Points = InputArray<double, nb::shape<-1, 3>>;
using Poses = InputArray<double, nb::shape<-1, 4, 4>>;
using Pose = InputArray<double, nb::shape<4, 4>>;
using Vector = InputArray<double, nb::shape<3>>;
using Pairs = InputArray<std::int32_t, nb::shape<-1, 2>>;

template <class T, class... Shape>
using OutputArray = nb::ndarray<nb::numpy, T, Shape..., nb::c_contig>;
template <class T>
using Column = OutputArray<T, nb::shape<-1>>;
template <class T, int N>
using Rows = OutputArray<T, nb::shape<-1, N>>;

/// The vector as an array of the given shape, without a copy. The interpreter's lock has to be held.
template <class Array, class T>
Array give(std::vector<T>&& values, std::initializer_list<std::size_t> shape) {
  auto held = std::make_unique<std::vector<T>>(std::move(values));
  T* data = held->data();
  const nb::capsule owner(held.get(), [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  static_cast<void>(held.release());
  return Array(data, shape, owner);
}

template <class T>
Column<T> giveColumn(std::vector<T>&& values) {
  const std::size_t count = values.size();
  return give<Column<T>>(std::move(values), {count});
}

template <int N, class T>
Rows<T, N> giveRows(std::vector<T>&& values) {
  const std::size_t count = values.size() / N;
  return give<Rows<T, N>>(std::move(values), {count, N});
}

}  // namespace otg::python
