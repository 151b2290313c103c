// A tone map or OpenColorIO view as a lookup table, applied to every pixel on the GPU.
#pragma once

#include <future>
#include <memory>
#include <vector>

#include "core/vec.h"
#include "relume/tone_map.h"

namespace relume {
class OcioView;
}  // namespace relume

namespace relume::viewer {

/// Range of the table: log2 of exposed radiance, which is clamped to it. Views with a larger range lose the rest.
inline constexpr float kTableMinEv = -12;
inline constexpr float kTableMaxEv = 8;

/// Display-encoded colours in [0, 1], red fastest. Entries per channel are at equal steps of log2, except that the
/// first is at radiance 0. Values between entries are interpolated linearly.
struct DisplayTable {
  int size = 0;  ///< entries per channel
  std::vector<Rgb> colors;
};

/// Interpolated colours differ from tone_map()'s by less than 0.5/255 on average.
DisplayTable display_table(ToneMap tone_map);

/// The same for a view, computed on all cores, at a higher resolution. Views may clip sharply, where the difference is
/// larger.
DisplayTable display_table(const OcioView& view);

/// A view and its table, which a thread of low priority computes.
class OcioDisplay {
 public:
  /// The tone map: neither view nor table.
  OcioDisplay() = default;
  /// Starts the computation. `view` may be nullptr: the tone map.
  explicit OcioDisplay(std::shared_ptr<const OcioView> view);

  const std::shared_ptr<const OcioView>& view() const { return view_; }  ///< nullptr: the tone map
  /// Whether table() returns at once.
  bool ready() const;
  /// The table, once it is complete, valid as long as this object or a copy; nullptr for the tone map. Throws the
  /// computation's error.
  const DisplayTable* table() const;

 private:
  std::shared_ptr<const OcioView> view_;
  std::shared_future<DisplayTable> table_;  ///< valid with a view
};

}  // namespace relume::viewer
