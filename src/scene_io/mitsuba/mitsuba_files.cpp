#include "scene_io/mitsuba/mitsuba_files.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::mitsuba {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxReference = 4096;

fs::path with_slashes(std::string_view reference) {
  std::string text(reference);
  std::replace(text.begin(), text.end(), '\\', '/');
  return text;
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

}  // namespace

bool Files::contains(const fs::path& path) const {
  const fs::path relative = path.lexically_normal().lexically_relative(root_.empty() ? "." : root_.lexically_normal());
  return !relative.empty() && *relative.begin() != "..";
}

bool Files::add_folder(const fs::path& base, std::string_view folder) {
  if (folder.size() > kMaxReference || folder.find('\0') != std::string_view::npos) return false;
  const fs::path path = base / with_slashes(folder);
  if (!contains(path)) return false;
  constexpr size_t kMaxFolders = 64;
  if (folders_.size() > kMaxFolders)
    throw Error(fmt::format("the scene has more than {} <path> elements; remove some", kMaxFolders));
  folders_.insert(folders_.begin(), path);
  return true;
}

std::optional<fs::path> Files::find(const fs::path& base, std::string_view reference) const {
  if (reference.size() > kMaxReference || reference.find('\0') != std::string_view::npos) return std::nullopt;
  const fs::path path = with_slashes(reference);
  const fs::path name = path.filename();
  if (name.empty() || name == "." || name == "..") return std::nullopt;
  std::vector<fs::path> candidates = {base / path};
  for (const fs::path& folder : folders_) candidates.push_back(folder / path);
  std::erase_if(candidates, [&](const fs::path& candidate) { return !contains(candidate); });
  candidates.push_back(root_ / name);
  candidates.push_back(root_ / "textures" / name);
  const auto found = std::find_if(candidates.begin(), candidates.end(), is_file);
  return (found == candidates.end() ? candidates.front() : *found).lexically_normal();
}

}  // namespace relume::mitsuba
