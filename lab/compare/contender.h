// Contenders of a comparison: presets, settings files, inline settings, and external images.
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
  SettingTexts settings = {};  ///< applied last
};

/// An external image.
struct ImageContender {
  std::string name;
  std::filesystem::path file;
};

/// Parses comma-separated contenders; KEY:VALUE continues the previous one:
///
///     interactive, default, psf    a preset, none, or a choice that only one slot has
///     file.json                    settings of a file, or of an EXR that relume wrote
///     mine=preview,seed:3          a custom name for any of these, or for settings alone
///
/// Throws Error that begins with `place` for invalid text, duplicate names and an empty list.
std::vector<Contender> parse_contenders(std::string_view text, std::string_view place);

/// Parses "cycles=a.exr,mitsuba=b.exr"; without a name, the file's name is used. Throws Error.
std::vector<ImageContender> parse_image_contenders(std::string_view text, std::string_view place);

/// Parses "lights:light-tree,estimator:bdpt". Throws Error that begins with `place` for invalid text.
SettingTexts parse_settings(std::string_view text, std::string_view place);

/// The contender's settings. `common` holds the settings of the scene and the command line. Settings of the comparison
/// itself (size, camera, time, environment, number of samples, threads) stay as in `common`. The order is defaults,
/// scene, preset, file, `common.flags`, inline. Throws Error for invalid settings.
AllSettings resolve_contender(const Contender& contender, const SettingSources& common);

struct ReferenceSettings {
  AllSettings settings;
  SettingTexts left_out = {};  ///< `common.flags` that the reference overrides
};

/// Settings of the reference: `common`, with the techniques of preset "reference" in every slot and its values of
/// biasing settings. It has as many bounces as the contender with the most: light from longer paths is not an error of
/// any contender. `own` is applied last. Throws Error for invalid settings.
ReferenceSettings resolve_reference(const SettingSources& common, const std::vector<AllSettings>& contenders,
                                    const SettingTexts& own);

}  // namespace relume
