// Views of OpenColorIO configurations, in place of a tone map.
#pragma once

#include <memory>
#include <string>

#include "relume/image.h"

namespace relume {

/// Why this build has no OpenColorIO; empty if it has.
std::string ocio_missing();

class OcioView {
 public:
  /// A configuration file, and the name of a view of its first display that has one of that name. Throws Error, with
  /// the names that exist for one that does not.
  OcioView(const std::string& file, const std::string& view);
  ~OcioView();
  OcioView(OcioView&&) noexcept;

  /// `radiance` times 2^exposure as the view shows it, in [0, 1] and without the sRGB transfer function, as tone_map()
  /// returns it: files that are written from it hold the view's own values. Radiance is linear Rec. 709: the
  /// configuration's colour space of one of its usual names, or else, with a note, the role scene_linear. Values that
  /// are not finite count as 0.
  Image apply(const Image& radiance, float exposure) const;

  /// Which colour space replaces linear Rec. 709 where the configuration has none; empty if it has.
  const std::string& note() const { return note_; }

 private:
  struct State;
  std::unique_ptr<const State> state_;
  std::string note_;
};

}  // namespace relume
