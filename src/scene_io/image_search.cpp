#include "scene_io/image_search.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "files/bytes.h"
#include "files/read_record.h"
#include "relume/error.h"

namespace relume {

std::filesystem::path find_image(const std::filesystem::path& base_dir, std::string_view reference,
                                 const std::string& place) {
  constexpr std::string_view kFileScheme = "file://";
  if (reference.starts_with(kFileScheme)) reference.remove_prefix(kFileScheme.size());
  std::string slashes(reference);
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  const std::filesystem::path name = std::filesystem::path(slashes).filename();
  const bool is_valid = reference.find('\0') == std::string_view::npos;  // otherwise resolve_uri() throws
  for (const auto& candidate :
       {base_dir / reference, base_dir / slashes, base_dir / name, base_dir / "textures" / name}) {
    std::error_code error;
    if (is_valid && std::filesystem::is_regular_file(candidate, error)) return candidate;
  }
  return resolve_uri(base_dir, reference, place);
}

std::filesystem::path find_inside(const std::filesystem::path& base_dir, std::string_view reference,
                                  const std::string& place) {
  std::string slashes(reference);
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  const std::filesystem::path path = std::filesystem::path(slashes).lexically_normal();
  const bool is_uri = slashes.find("://") != std::string::npos;
  const bool leaves = is_uri || path.is_absolute() || (!path.empty() && *path.begin() == "..");
  if (!leaves) return find_image(base_dir, reference, place);
  const std::filesystem::path file = find_image(base_dir, path.filename().string(), place);
  if (missing_reason(file).empty()) return file;
  record_read(file);
  throw Error(ErrorCode::not_found,
              fmt::format("{}: '{}' lies outside of the scene's folder; move it inside", place, reference));
}

}  // namespace relume
