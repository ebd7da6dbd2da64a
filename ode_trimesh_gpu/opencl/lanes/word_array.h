// SPDX-License-Identifier: BSD-3-Clause
// Arrays of items that are sent to the device and a word for each that comes back, with the mesh that they are about.
#pragma once

#include <cstddef>
#include <span>

#include "opencl/meshes/mesh_store.h"
#include "opencl/runtime/given.h"
#include "opencl/runtime/pinned_buffer.h"
#include "shared/layout/queries_given.h"

namespace otg::opencl {

/// Items are of so many `Element` each. One thread at a time. After a ClError it is of no further use.
template <class Element>
class WordArray {
 public:
  WordArray(Context& context, MeshStore& meshes, std::size_t group, std::size_t itemSize)
      : context_(context),
        meshes_(meshes),
        group_(group),
        itemSize_(itemSize),
        queue_(context.makeQueue(false)),
        items_(itemSize / sizeof(Element)) {}
  ~WordArray() {
    if (underWay_) clRelease(OTG_CL(clFinish), queue_.get());
  }
  WordArray(const WordArray&) = delete;
  WordArray& operator=(const WordArray&) = delete;

  /// Room for so many items in host memory. Throws ClError.
  void* makeRoom(std::size_t count) {
    sent_.reserve(context_, queue_.get(), count * itemSize_);
    count_ = count;
    return sent_.data();
  }
  /// The items that were sent last.
  const void* items() const { return sent_.data(); }
  std::size_t count() const { return count_; }

  /// Sends the items that were written there, and the mesh if the device has not got it; does not wait. Throws ClError.
  void send(const CollisionMesh& mesh) {
    words_.reserve(context_, count_);
    items_.reserve(context_, count_);
    received_.reserve(context_, queue_.get(), count_ * sizeof(otg_uint));
    const CollisionMesh* const one[] = {&mesh};
    mesh_ = meshes_.acquire(one);
    underWay_ = true;
    writeLater(queue_.get(), items_.get(), count_ * itemSize_, sent_.data());
  }
  /// What kernels are given of what was sent: the mesh's place, the meshes, the items and how many they are.
  const otg_device_mesh& place() const { return mesh_[0]; }
  BufferOf<const otg_mesh_unit> meshes() const { return mesh_.units(); }
  BufferOf<const Element> sentItems() const { return items_.buffer(); }
  otg_uint sentCount() const { return static_cast<otg_uint>(count_); }
  /// Where they write the words.
  BufferOf<otg_array_answer> words() const { return words_.buffer(); }
  /// A work-item to an item.
  template <class Given>
  void run(KernelFor<Given>& kernel, const Given& given) {
    kernel.give(given);
    launch(queue_.get(), kernel, group_, (count_ + group_ - 1) / group_);
  }
  /// Has the words sent back; does not wait.
  void receive() {
    clDo(OTG_CL(clEnqueueReadBuffer), queue_.get(), words_.get(), cl_bool{CL_FALSE}, std::size_t{0},
         count_ * sizeof(otg_uint), static_cast<void*>(received_.data()), cl_uint{0},
         static_cast<const cl_event*>(nullptr), static_cast<cl_event*>(nullptr));
    clDo(OTG_CL(clFlush), queue_.get());
  }
  /// Waits for them. Throws ClError.
  std::span<const otg_uint> end() {
    clDo(OTG_CL(clFinish), queue_.get());
    underWay_ = false;
    mesh_ = {};
    return {reinterpret_cast<const otg_uint*>(received_.data()), count_};
  }

 private:
  Context& context_;
  MeshStore& meshes_;
  const std::size_t group_, itemSize_;
  QueueHandle queue_;
  ListOf<Element> items_;
  ListOf<otg_array_answer> words_;
  PinnedBuffer sent_, received_;
  MeshStore::Pinned mesh_;
  std::size_t count_ = 0;
  bool underWay_ = false;
};

}  // namespace otg::opencl
