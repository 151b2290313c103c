// Typed names of per-pixel buffers. Each key is one constant: in shared_buffers.h if several techniques use the buffer,
// otherwise beside the pass that owns it.
#pragma once

#include <cstdint>
#include <string_view>
#include <type_traits>

#include "core/vec.h"

namespace relume {

/// Element type of a buffer. `record`: a struct that only kernels read.
enum class BufferType : uint8_t { f32, rgb32f, vec2f, u32, record };

/// Buffer type for elements of type T.
template <typename T>
constexpr BufferType buffer_type() {
  if constexpr (std::is_same_v<T, float>) return BufferType::f32;
  if constexpr (std::is_same_v<T, Rgb>) return BufferType::rgb32f;
  if constexpr (std::is_same_v<T, Vec2>) return BufferType::vec2f;
  if constexpr (std::is_same_v<T, uint32_t>) return BufferType::u32;
  return BufferType::record;
}

/// A key without its static type, for lists of buffers.
struct BufferId {
  std::string_view name = {};  ///< unique, in kebab case
  BufferType type = BufferType::f32;
  uint32_t element_bytes = sizeof(float);

  friend bool operator==(const BufferId&, const BufferId&) = default;
};

/// Name of a buffer with elements of type T.
template <typename T>
struct BufferKey {
  static_assert(std::is_trivially_copyable_v<T>);
  std::string_view name = {};  ///< empty: no buffer

  constexpr operator BufferId() const {  // NOLINT(google-explicit-constructor): the same key
    return {name, buffer_type<T>(), sizeof(T)};
  }
};

}  // namespace relume
