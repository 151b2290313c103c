// Writes the view as relume JSON (docs/scene-json.md), readable by every other command.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "viewer/model/camera_path.h"
#include "viewer/model/document.h"

namespace relume::viewer {

struct SavedView {
  const Document& document;
  const AllSettings& settings;
  CameraPose camera;
  const CameraPath* path = nullptr;  ///< two keys or more animate the camera; nullptr: static
  bool has_ocio_view = false;        ///< whether an OpenColorIO view replaces the tone map
};

/// The file's text for a file in `folder`. Content that relume JSON cannot express is reported in `omissions`, one
/// sentence each.
std::string view_as_json(const SavedView& view, const std::filesystem::path& folder,
                         std::vector<std::string>& omissions);

/// Writes the file. Returns the omissions. Throws Error.
std::vector<std::string> save_view(const std::filesystem::path& file, const SavedView& view);

}  // namespace relume::viewer
