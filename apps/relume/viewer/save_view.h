// Writes what is shown as relume JSON (docs/scene-json.md), so that every other command takes it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "viewer/camera_path.h"
#include "viewer/document.h"

namespace relume::viewer {

struct SavedView {
  const Document& document;
  const AllSettings& settings;
  CameraPose camera;
  const CameraPath* path = nullptr;  ///< two keys or more move the camera; nullptr: it rests
};

/// The file's text, if it stands in `folder`; what relume JSON cannot say goes to `omissions`, one sentence each.
std::string view_as_json(const SavedView& view, const std::filesystem::path& folder,
                         std::vector<std::string>& omissions);

/// Writes it. Returns the omissions. Throws Error.
std::vector<std::string> save_view(const std::filesystem::path& file, const SavedView& view);

}  // namespace relume::viewer
