#include "viewer/model/camera_path.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "relume/error.h"

namespace relume::viewer {
namespace {

using nlohmann::json;

json to_json(const Bookmark& b) {
  const glm::quat& q = b.view.rotation;
  return {{"name", b.name},
          {"eye", {b.view.eye.x, b.view.eye.y, b.view.eye.z}},
          {"rotation", {q.x, q.y, q.z, q.w}},
          {"fov_y_rad", b.view.fov_y_rad}};
}

Bookmark bookmark_from_json(const json& object) {
  const auto eye = object.at("eye").get<std::array<float, 3>>();
  const auto q = object.at("rotation").get<std::array<float, 4>>();
  Bookmark b{object.at("name").get<std::string>(),
             {Vec3(eye[0], eye[1], eye[2]), glm::quat(q[3], q[0], q[1], q[2]), object.at("fov_y_rad").get<float>()}};
  const float length = glm::length(b.view.rotation);
  if (!is_finite(b.view.eye) || !(length > 0.5f && length < 2) || !(b.view.fov_y_rad > 0 && b.view.fov_y_rad < kPi)) {
    throw Error("invalid viewpoint");
  }
  b.view.rotation = glm::normalize(b.view.rotation);
  return b;
}

}  // namespace

std::vector<Bookmark> read_bookmarks(const std::filesystem::path& file) {
  std::error_code failure;
  if (!std::filesystem::exists(file, failure)) return {};
  const std::vector<std::byte> bytes = read_file(file, 1 << 24);
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  try {
    const json root = json::parse(text, text + bytes.size());
    std::vector<Bookmark> result;
    for (const json& object : root.at("bookmarks")) result.push_back(bookmark_from_json(object));
    return result;
  } catch (const std::exception&) {
    throw Error(fmt::format("{}: invalid bookmarks; delete the file to start without any", file.string()));
  }
}

void write_bookmarks(const std::filesystem::path& file, const std::vector<Bookmark>& bookmarks) {
  std::error_code failure;  // write_file() reports problems of the folder
  std::filesystem::create_directories(file.parent_path(), failure);
  json list = json::array();
  for (const Bookmark& bookmark : bookmarks) list.push_back(to_json(bookmark));
  write_file(file, json{{"bookmarks", list}}.dump(1) + "\n");
}

void CameraPath::add(const PathKey& key) {
  if (keys_.empty() || key.time_s > keys_.back().time_s) keys_.push_back(key);
}

PathKey CameraPath::at(float time_s) const {
  if (keys_.empty()) return {};
  const auto after = std::find_if(keys_.begin(), keys_.end(), [&](const PathKey& k) { return k.time_s > time_s; });
  if (after == keys_.begin()) return keys_.front();
  if (after == keys_.end()) return keys_.back();
  const PathKey& a = *(after - 1);
  const PathKey& b = *after;
  const float t = (time_s - a.time_s) / (b.time_s - a.time_s);
  return {time_s, glm::mix(a.eye, b.eye, t), glm::slerp(a.rotation, b.rotation, t)};
}

}  // namespace relume::viewer
