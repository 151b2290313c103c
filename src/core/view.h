// A pointer and a count: non-owning access to arrays in kernels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hd.h"

namespace relume {

template <typename T>
struct View {
  T* data = nullptr;
  uint32_t size = 0;
  uint32_t unused = 0;  ///< a member in place of padding, so that equal views have equal bytes

  RELUME_HD T& operator[](uint32_t i) const { return data[i]; }
  RELUME_HD T* begin() const { return data; }
  RELUME_HD T* end() const { return data + size; }
  RELUME_HD bool empty() const { return size == 0; }
};

/// View of one element; valid while the element exists.
template <typename T>
RELUME_HD View<T> view_of_one(T& element) {
  return {&element, 1};
}

/// View of all elements; valid until `v` is destroyed or resized. Kernels that a backend launches take views of arrays
/// (core/array.h) instead.
template <typename T>
View<const T> view_of(const std::vector<T>& v) {
  return {v.data(), static_cast<uint32_t>(v.size())};
}
template <typename T>
View<T> mutable_view_of(std::vector<T>& v) {
  return {v.data(), static_cast<uint32_t>(v.size())};
}
/// The same for elements that an array has opened for the host.
template <typename T>
View<const T> view_of(std::span<const T> v) {
  return {v.data(), static_cast<uint32_t>(v.size())};
}
template <typename T>
View<T> mutable_view_of(std::span<T> v) {
  return {v.data(), static_cast<uint32_t>(v.size())};
}

}  // namespace relume
