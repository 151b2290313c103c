// Sets, copies and resizes arrays in launches.
#pragma once

#include <algorithm>
#include <stop_token>
#include <string_view>

#include "core/array.h"
#include "core/hd.h"
#include "core/view.h"
#include "frame/launch.h"

namespace relume {

/// Number of elements per tile of the kernels below.
inline constexpr uint32_t kFillTile = 16384;

template <typename T>
struct FillElementsKernel {
  View<T> elements;
  T value;

  RELUME_HD void operator()(uint32_t i, uint32_t) const { elements[i] = value; }
  void operator()(const Tile& tile) const { std::fill(elements.data + tile.x0, elements.data + tile.x1, value); }
};

template <typename T>
struct CopyElementsKernel {
  View<const T> from;
  View<T> to;

  RELUME_HD void operator()(uint32_t i, uint32_t) const { to[i] = from[i]; }
  void operator()(const Tile& tile) const { std::copy(from.data + tile.x0, from.data + tile.x1, to.data + tile.x0); }
};

template <typename T>
struct TakeElementsKernel {
  View<const T> from;
  View<T> to;
  uint32_t stride;

  RELUME_HD void operator()(uint32_t i, uint32_t) const { to[i] = from[i * stride]; }
};

/// Sets all elements. Returns false if `stop` was requested first; some elements are then unchanged.
template <typename T>
bool fill(Backend& backend, std::string_view name, View<T> elements, const T& value, const std::stop_token& stop = {}) {
  return launch(backend, name, FillElementsKernel<T>{elements, value}, elements.size, 1, stop, kFillTile);
}

/// Copies all elements of `from` to the first elements of `to`, which is no smaller and does not overlap. Returns false
/// if `stop` was requested first; some elements are then unchanged.
template <typename T>
bool copy(Backend& backend, std::string_view name, View<const T> from, View<T> to, const std::stop_token& stop = {}) {
  return launch(backend, name, CopyElementsKernel<T>{from, to}, from.size, 1, stop, kFillTile);
}

/// Copies elements 0, stride, 2 stride … of `from` to the elements of `to`, all of which must have a source.
template <typename T>
void take_elements(Backend& backend, std::string_view name, View<const T> from, uint32_t stride, View<T> to) {
  launch(backend, name, TakeElementsKernel<T>{from, to, stride}, to.size, 1, {}, kFillTile);
}

/// Replaces the content of `to` by that of `from`. Changes nothing if memory is missing.
template <typename T>
void copy(Backend& backend, std::string_view name, const Array<T>& from, Array<T>& to) {
  to.reset(from.size(), kUninitialized);
  if (!from.empty()) copy(backend, name, from.view(), to.mutable_view());
}

/// Array::resize() in a launch: keeps the first elements and sets new ones to T{}. Changes nothing if it throws.
template <typename T>
void resize(Backend& backend, std::string_view name, Array<T>& array, size_t size) {
  const size_t old = std::min(array.size(), size);
  array.resize(size, kUninitialized);
  if (old == size) return;
  const View<T> elements = array.mutable_view();
  try {
    fill(backend, name, View<T>{elements.data + old, elements.size - static_cast<uint32_t>(old)}, T{});
  } catch (...) {
    array.resize(old, kUninitialized);
    throw;
  }
}

/// Array::reset() in a launch: replaces the content by `size` elements `value`.
template <typename T>
void reset(Backend& backend, std::string_view name, Array<T>& array, size_t size, const T& value = {}) {
  array.reset(size, kUninitialized);
  if (size > 0) fill(backend, name, array.mutable_view(), value);
}

}  // namespace relume
