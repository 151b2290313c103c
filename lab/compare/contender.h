// What is compared: presets, settings files, settings written inline, and images made elsewhere.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/settings.h"

namespace relume {

/// Names and texts of settings.
using SettingTexts = std::vector<std::pair<std::string, std::string>>;

struct Contender {
  std::string name;
  std::string preset = {};     ///< empty: none
  std::string file = {};       ///< JSON, or an EXR that relume wrote; empty: none
  SettingTexts settings = {};  ///< on top
};

/// An image made elsewhere.
struct ImageContender {
  std::string name;
  std::filesystem::path file;
};

/// Contenders with commas between them:
///
///     interactive                            the preset of that name; "default": no preset
///     psf                                    a technique: the choice of that name, if only one slot has it
///     file.json                              settings from a file, or from an EXR that relume wrote
///     uniform=lights:uniform                 settings inline, under a name of one's own
///     mine=preview,max-bounces:2,seed:3      a preset or a file with settings on top
///
/// KEY:VALUE continues the contender before it. Throws Error that begins with `place` for what cannot be read, for two
/// of one name, and if there is none.
std::vector<Contender> parse_contenders(std::string_view text, std::string_view place);

/// "cycles=a.exr,mitsuba=b.exr"; a file without a name goes by its own. Throws Error.
std::vector<ImageContender> parse_image_contenders(std::string_view text, std::string_view place);

/// "lights:light-tree,estimator:bdpt". Throws Error that begins with `place` for what cannot be read.
SettingTexts parse_settings(std::string_view text, std::string_view place);

/// The contender's settings. `common` holds what the scene and the command line say; what belongs to the comparison
/// rather than to a technique (size, camera, time, environment, number of samples, threads) is as `common` has it. The
/// order is defaults, scene, preset, file, `common.flags`, inline. Throws Error for what does not fit.
AllSettings resolve_contender(const Contender& contender, const SettingSources& common);

struct ReferenceSettings {
  AllSettings settings;
  SettingTexts left_out = {};  ///< of `common.flags`, what the reference does otherwise
};

/// What the contenders are measured against: as `common` has it, but with the techniques of preset "reference" in every
/// slot and its values wherever some bias; with as many bounces as the contender that has the most, for light from
/// longer paths is nobody's error; and with `own` on top. Throws Error for what does not fit.
ReferenceSettings resolve_reference(const SettingSources& common, const std::vector<AllSettings>& contenders,
                                    const SettingTexts& own);

}  // namespace relume
