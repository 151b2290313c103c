// Mitsuba scenes for tests.
#pragma once

#include <string>

#include "scene_io/mitsuba/mitsuba_loader.h"
#include "scene_io/testing/scene_files.h"

namespace relume::testing {

/// Loads the elements of a <scene> of version 3; files are relative to `folder`.
inline Scene load_mitsuba_text(const std::string& elements, const std::filesystem::path& folder = "/nonexistent") {
  return load_mitsuba_from_memory(to_bytes("<scene version=\"3.0.0\">\n" + elements + "\n</scene>\n"), folder, "a.xml");
}

/// Scene of a sphere with a BSDF, whose material is the first one.
inline Scene load_mitsuba_bsdf(const std::string& bsdf, const std::filesystem::path& folder = "/nonexistent") {
  return load_mitsuba_text("<shape type=\"sphere\">" + bsdf + "</shape>", folder);
}

}  // namespace relume::testing
