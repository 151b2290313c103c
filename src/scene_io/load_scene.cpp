#include <fmt/format.h>

#include "core/activity.h"
#include "files/read_record.h"
#include "relume/error.h"
#include "relume/scene_io.h"
#include "scene_io/scene_format.h"

namespace relume {
namespace {

/// Throws Error unless the file exists and is not empty.
void check_file(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw Error(ErrorCode::not_found, fmt::format("{}: the file does not exist; check its path", file.string()));
  if (std::filesystem::file_size(file, error) == 0)
    throw Error(fmt::format("{}: the file is empty; export or copy it again", file.string()));
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  const Activity activity("loading " + file.filename().string());
  const ReadRecord record;
  record_read(file);  // comes first in Scene::source_files
  const SceneFormat& format = scene_format_of(file);
  check_file(file);
  Scene scene = format.load(file);
  scene.source_files = record.files();
  return scene;
}

}  // namespace relume
