#include "scene/animation.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume {
namespace {

glm::quat quat_from_xyzw(const Vec4& v) { return {v.w, v.x, v.y, v.z}; }

/// Value of key `i`, without the tangents of a cubic spline.
template <typename Channel>
Vec4 key_value(const Channel& channel, size_t i) {
  return channel.interpolation == Interpolation::cubic_spline ? channel.values[3 * i + 1] : channel.values[i];
}

/// glTF 2.0, appendix C: Hermite spline with tangents scaled by the interval `dt`.
template <typename Channel>
Vec4 cubic_spline(const Channel& channel, size_t i, float dt, float t) {
  const Vec4 v0 = channel.values[3 * i + 1];
  const Vec4 b0 = channel.values[3 * i + 2] * dt;
  const Vec4 a1 = channel.values[3 * i + 3] * dt;
  const Vec4 v1 = channel.values[3 * i + 4];
  const float t2 = t * t;
  const float t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * v0 + (t3 - 2 * t2 + t) * b0 + (-2 * t3 + 3 * t2) * v1 + (t3 - t2) * a1;
}

/// Value between the keys of any channel. `turns`: the values are quaternions.
template <typename Channel>
Vec4 value_at(const Channel& channel, float time_s, bool turns) {
  const auto& times = channel.times;
  if (!(time_s > times.front())) return key_value(channel, 0);  // also for NaN
  if (time_s >= times.back()) return key_value(channel, times.size() - 1);
  const auto next = std::upper_bound(times.begin(), times.end(), time_s);
  const size_t i = static_cast<size_t>(next - times.begin()) - 1;
  const float dt = times[i + 1] - times[i];
  const float t = (time_s - times[i]) / dt;
  switch (channel.interpolation) {
    case Interpolation::step: return key_value(channel, i);
    case Interpolation::cubic_spline: return cubic_spline(channel, i, dt, t);
    case Interpolation::linear: break;
  }
  const Vec4 a = channel.values[i];
  const Vec4 b = channel.values[i + 1];
  if (!turns) return a + (b - a) * t;
  const glm::quat q = glm::slerp(quat_from_xyzw(a), quat_from_xyzw(b), t);
  return {q.x, q.y, q.z, q.w};
}

std::string known_clips(const Scene& scene) {
  if (scene.clips.empty()) return "the scene has no named animations; remove --animation";
  std::string names;
  for (const std::string& name : scene.clips) names += (names.empty() ? "'" : ", '") + name + "'";
  return "it has " + names;
}

/// Finds a clip by name or number. Throws Error if none matches.
Index find_clip(const Scene& scene, std::string_view name) {
  const auto found = std::find(scene.clips.begin(), scene.clips.end(), name);
  if (found != scene.clips.end()) return static_cast<Index>(found - scene.clips.begin());
  size_t index = 0;
  const auto parsed = std::from_chars(name.data(), name.data() + name.size(), index);
  if (parsed.ec == std::errc{} && parsed.ptr == name.data() + name.size() && index < scene.clips.size())
    return static_cast<Index>(index);
  throw Error(ErrorCode::not_found,
              fmt::format("{}: there is no animation '{}'; {}", error_place(scene), name, known_clips(scene)));
}

std::set<Index> chosen_clips(const Scene& scene, const std::string& choice) {
  std::set<Index> clips;
  if (choice == "all") {
    for (size_t i = 0; i < scene.clips.size(); ++i) clips.insert(static_cast<Index>(i));
  } else if (choice.empty()) {
    clips.insert(0);
  } else if (std::find(scene.clips.begin(), scene.clips.end(), choice) != scene.clips.end()) {
    clips.insert(find_clip(scene, choice));  // a name may contain a comma
  } else {
    for (size_t begin = 0; begin <= choice.size();) {
      const size_t end = std::min(choice.find(',', begin), choice.size());
      clips.insert(find_clip(scene, std::string_view(choice).substr(begin, end - begin)));
      begin = end + 1;
    }
  }
  return clips;
}

}  // namespace

Vec4 evaluate(const AnimationChannel& channel, float time_s) {
  return value_at(channel, time_s, channel.property == AnimatedProperty::rotation);
}

Vec4 evaluate(const ParameterChannel& channel, float time_s) { return value_at(channel, time_s, false); }

bool is_transform(AnimatedProperty property) {
  return property == AnimatedProperty::translation || property == AnimatedProperty::rotation ||
         property == AnimatedProperty::scale;
}

void apply(const AnimationChannel& channel, float time_s, Transform& transform) {
  const Vec4 value = evaluate(channel, time_s);
  switch (channel.property) {
    case AnimatedProperty::translation: transform.translation = Vec3(value); break;
    case AnimatedProperty::rotation: transform.rotation = glm::normalize(quat_from_xyzw(value)); break;
    case AnimatedProperty::scale: transform.scale = Vec3(value); break;
    case AnimatedProperty::morph_weight:
    case AnimatedProperty::visible: break;
  }
}

ValueRange value_range(const AnimationChannel& channel) {
  ValueRange range{key_value(channel, 0).x, key_value(channel, 0).x};
  const auto add = [&](float x) {
    range.low = std::min(range.low, x);
    range.high = std::max(range.high, x);
  };
  for (size_t i = 0; i < channel.times.size(); ++i) {
    add(key_value(channel, i).x);
    if (channel.interpolation != Interpolation::cubic_spline || i + 1 == channel.times.size()) continue;
    // A Bézier curve stays within its control points.
    const float third = (channel.times[i + 1] - channel.times[i]) / 3.0f;
    add(key_value(channel, i).x + channel.values[3 * i + 2].x * third);
    add(key_value(channel, i + 1).x - channel.values[3 * i + 3].x * third);
  }
  return range;
}

void select_animation(Scene& scene, const std::string& choice) {
  const std::set<Index> clips = chosen_clips(scene, choice);
  std::set<std::tuple<Index, AnimatedProperty, Index>> driven;
  std::erase_if(scene.animation, [&](const AnimationChannel& c) {
    if (c.clip != kNone && !clips.contains(c.clip)) return true;
    return !driven.emplace(c.node, c.property, c.morph_target).second;
  });
  std::set<std::tuple<AnimatedPart, Index, std::string>> driven_parameters;
  std::erase_if(scene.parameter_animation, [&](const ParameterChannel& c) {
    if (c.clip != kNone && !clips.contains(c.clip)) return true;
    return !driven_parameters.emplace(c.part, c.index, c.parameter).second;
  });
}

float animation_end(const Scene& scene) {
  float end = 0;
  for (const AnimationChannel& channel : scene.animation) end = std::max(end, channel.times.back());
  for (const ParameterChannel& channel : scene.parameter_animation) end = std::max(end, channel.times.back());
  return end;
}

}  // namespace relume
