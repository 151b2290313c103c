// Views of OpenColorIO configurations, which replace the tone map.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "relume/image.h"

namespace relume {

/// Reason why this build lacks OpenColorIO; empty if it is included.
std::string ocio_missing();

class OcioView {
 public:
  /// Loads a configuration file and selects the view `view` of the first display that has it. Throws Error for unknown
  /// names, with the existing ones.
  OcioView(const std::string& file, const std::string& view);
  ~OcioView();
  OcioView(OcioView&&) noexcept;

  /// Applies the view to `radiance` times 2^exposure. Returns values in [0, 1] without the sRGB transfer function, like
  /// tone_map(): written files then contain the view's values. Radiance is linear Rec. 709: the configuration's colour
  /// space with one of the usual names, or else, with a note, the role scene_linear. Non-finite values count as 0.
  Image apply(const Image& radiance, float exposure) const;

  /// The same, display-encoded: the view's values.
  Image encode(const Image& radiance, float exposure) const;

  /// Colour space that replaces linear Rec. 709 if the configuration lacks it; otherwise empty.
  const std::string& note() const { return note_; }

  /// Files that the view reads besides the configuration, such as look-up tables, as found on its search path.
  const std::vector<std::filesystem::path>& files() const { return files_; }

 private:
  struct State;
  std::unique_ptr<const State> state_;
  std::string note_;
  std::vector<std::filesystem::path> files_;
};

}  // namespace relume
