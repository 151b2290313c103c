// A copy of a structure that learns, for the frames of an epoch to sample with.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>

#include "core/stream_io.h"

namespace relume {

/// Structures take in samples in every frame, but an epoch samples with what its first frame had: samples may then be
/// stratified over its frames, and stay independent of what guides them. Copies only where an epoch has a second frame.
template <typename T>
class Snapshot {
 public:
  /// Call in each frame before `learning` takes in samples.
  void begin_frame(bool begins_epoch, const T& learning) {
    if (begins_epoch) {
      copy_.reset();
    } else if (!copy_) {
      copy_ = learning;
    }
  }
  /// The structure to sample with; `learning` where the epoch began with this frame.
  const T& of(const T& learning) const { return copy_ ? *copy_ : learning; }
  T& of(T& learning) { return copy_ ? *copy_ : learning; }
  bool frozen() const { return copy_.has_value(); }
  void reset() { copy_.reset(); }

  size_t memory_bytes() const { return copy_ ? copy_->memory_bytes() : 0; }

  void save(std::ostream& out) const {
    write_value(out, static_cast<uint8_t>(frozen()));
    if (copy_) copy_->save(out);
  }
  /// `empty`: what load() of the structure may start from.
  void load(std::istream& in, T empty) {
    copy_.reset();
    uint8_t is_frozen = 0;
    read_value(in, is_frozen);
    if (!in || is_frozen == 0) return;
    empty.load(in);
    copy_ = std::move(empty);
  }

 private:
  std::optional<T> copy_;
};

}  // namespace relume
