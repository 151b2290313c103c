// A hash of bytes for names of files and checksums. What kernels hash with is in core/hash.h.
#pragma once

#include <cstddef>
#include <cstdint>

namespace relume {

/// FNV-1a, 64 bits, of bytes however they are cut into pieces.
class Fnv1a {
 public:
  Fnv1a() = default;
  /// Hashes with another salt have nothing to do with each other; 0 is the standard's.
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
