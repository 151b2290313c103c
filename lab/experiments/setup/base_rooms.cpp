#include "experiments/setup/base_rooms.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "builtin_scenes/builder.h"
#include "experiments/setup/learning_scenes.h"

namespace relume {
namespace {

constexpr float kEye_m = 1.6f;        // above the crates
constexpr float kFromWalls_m = 0.5f;  // to the middle of the wall
constexpr float kTargetHeight_m = 1.2f;

}  // namespace

const char* name_of(BaseLamps lamps) {
  switch (lamps) {
    case BaseLamps::strips: return "strips";
    case BaseLamps::panels: return "panels";
    case BaseLamps::screens: return "screens";
    case BaseLamps::dim: return "dim lamps";
    case BaseLamps::skylight: break;
  }
  return "skylight";
}

std::optional<BaseRoomView> base_room_view(uint32_t seed, BaseLamps lamps) {
  const BasePlan plan = make_base_plan(seed);
  const auto room = std::find_if(plan.rooms.begin(), plan.rooms.end(),
                                 [&](const BaseRoom& candidate) { return candidate.lamps == lamps; });
  if (room == plan.rooms.end()) return std::nullopt;
  BaseRoomView view{learning_scene(fmt::format("base-{}", seed)), *room};
  view.scene.name += fmt::format(", {}", name_of(lamps));
  const Vec2 eye = room->low + kFromWalls_m;
  const Vec2 target = room->high - kFromWalls_m;
  const Transform pose = look_at({eye.x, kEye_m, eye.y}, {target.x, kTargetHeight_m, target.y});
  view.scene.camera->to_world = glm::translate(Mat4(1), pose.translation) * glm::mat4_cast(pose.rotation);
  return view;
}

}  // namespace relume
