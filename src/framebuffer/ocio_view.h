// Views of OpenColorIO configurations, in place of a tone map.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "relume/image.h"

namespace relume {

/// Why this build has no OpenColorIO; empty if it has.
std::string ocio_missing();

class OcioView {
 public:
  /// "CONFIG:VIEW": a configuration file, and the name of a view of its first display that has one of that name. Throws
  /// Error, with the names that exist for one that does not.
  explicit OcioView(std::string_view text);
  ~OcioView();
  OcioView(OcioView&&) noexcept;

  /// `radiance` times 2^exposure as the view shows it, in [0, 1] and without the sRGB transfer function, as tone_map()
  /// returns it: files that are written from it hold the view's own values. Radiance is linear Rec. 709: the
  /// configuration's colour space of one of its usual names, or else the role scene_linear. Values that are not finite
  /// count as 0.
  Image apply(const Image& radiance, float exposure) const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace relume
