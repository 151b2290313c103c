// A byte hash for file names and checksums. Kernels use core/hash.h.
#pragma once

#include <cstddef>
#include <cstdint>

namespace relume {

/// 64-bit FNV-1a, independent of how the bytes are split into calls.
class Fnv1a {
 public:
  Fnv1a() = default;
  /// Different salts give unrelated hashes; 0 gives the standard one.
  explicit Fnv1a(uint64_t salt) : value_(kBegin ^ salt) {}

  void add(const void* data, size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < size; ++i) value_ = (value_ ^ bytes[i]) * 0x100000001b3u;
  }
  uint64_t value() const { return value_; }

 private:
  static constexpr uint64_t kBegin = 0xcbf29ce484222325u;
  uint64_t value_ = kBegin;
};

}  // namespace relume
