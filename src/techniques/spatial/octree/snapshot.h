// A copy of an adaptive structure that the frames of an epoch sample.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>

#include "core/stream_io.h"
#include "frame/launch.h"

namespace relume {

/// A structure receives samples in every frame, but the frames of an epoch sample its state in the first of them.
/// Their samples can then be stratified and stay independent of the structure. Only epochs of several frames copy.
/// T::copy(backend) copies in launches.
template <typename T>
class Snapshot {
 public:
  /// Call in each frame before `learning` receives samples.
  void begin_frame(Backend& backend, bool begins_epoch, const T& learning) {
    if (begins_epoch) {
      copy_.reset();
    } else if (!copy_) {
      copy_ = learning.copy(backend);
    }
  }
  /// The structure to sample; `learning` in the first frame of an epoch.
  const T& of(const T& learning) const { return copy_ ? *copy_ : learning; }
  T& of(T& learning) { return copy_ ? *copy_ : learning; }
  bool frozen() const { return copy_.has_value(); }
  void reset() { copy_.reset(); }

  size_t memory_bytes() const { return copy_ ? copy_->memory_bytes() : 0; }

  void save(std::ostream& out) const {
    write_value(out, static_cast<uint8_t>(frozen()));
    if (copy_) copy_->save(out);
  }
  /// `empty`: a structure whose load() is called.
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
