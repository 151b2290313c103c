#include "techniques/reuse/restir_pt/path_shift.h"

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/shapes.h"
#include "scene/testing/media.h"
#include "techniques/reuse/restir_pt/testing/random_choices.h"
#include "techniques/reuse/restir_pt/testing/traced_paths.h"
#include "techniques/transport/path/testing/run_kernel.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::Random;
using testing::rule_of;
using testing::TracedPaths;

struct Case {
  const char* name;
  const char* scene;
  PathShiftKind shift;
  ConnectRuleKind connect = ConnectRuleKind::footprint;
  bool learns = false;  ///< whether the paths come from random learned directions and lights
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
std::string case_name(const ::testing::TestParamInfo<Case>& info) { return info.param.name; }

class PathShift : public ::testing::TestWithParam<Case> {
 protected:
  static TracedPaths trace(uint32_t sample = 3) {
    const Case& c = GetParam();
    const Scene scene = find_builtin_scene(c.scene)->build();
    if (!c.learns) return {scene, rule_of(c.shift, c.connect), 6, sample};
    testing::RandomChoices choices(TracedPaths::kPixels);
    choices.learning.learns_lights = true;
    return {scene, rule_of(c.shift, c.connect), 6, sample, choices.directions, choices.learning};
  }
};

class PathLuminance : public PathShift {};

/// Relative difference of luminances.
double difference(const Rgb& a, const Rgb& b) {
  const auto x = static_cast<double>(luminance(a));
  const auto y = static_cast<double>(luminance(b));
  return std::fabs(x - y) / std::max(x, y);
}

/// The path of a pixel, shifted to that pixel, is itself.
TEST_P(PathShift, IsTheIdentityWithinAPixel) {
  int paths = 0;
  int replayed = 0;
  int other = 0;
  for (uint32_t sample = 0; sample < 4; ++sample) {
    const TracedPaths traced = trace(sample);
    for (uint32_t p = 0; p < TracedPaths::kPixels; ++p) {
      if (!traced.has_path(p)) continue;
      ++paths;
      const StoredPath& path = traced.reservoirs[p].sample;
      ASSERT_TRUE(exists(traced.shifter.context.scene, path, traced.shifter.context.max_bounces));
      const Shifted self = traced.shifted(p, p);
      const bool equal = self.result == ShiftResult::defined && difference(self.value, path.value) < 0.01;
      other += equal ? 0 : 1;
      if (path.joint() != 0) continue;
      ++replayed;
      EXPECT_EQ(self.result, ShiftResult::defined);
      EXPECT_LT(difference(self.value, path.value), 1e-5);
      EXPECT_EQ(self.first, path.first);
    }
  }
  EXPECT_GT(paths, 800);
  // Rounding may move a ray to the other side of an edge, or a density across a bound.
  EXPECT_LE(other, paths / 200) << "of " << paths;
  RecordProperty("replayed", replayed);
}

/// Frames after a movement of the camera have another seed, and perhaps another sequence.
TEST_P(PathShift, KeepsItsRandomNumbersInLaterFrames) {
  TracedPaths traced = trace();
  const SampleIndex later{.seed = 8, .sequence = 5, .sample = 0, .frame = 4, .age = 0};
  const SampleIndex own = std::exchange(traced.shifter.index, later);
  int defined = 0;
  for (uint32_t p = 0; p + 1 < TracedPaths::kPixels; ++p) {
    if (!traced.has_path(p) || !traced.records[p + 1].valid()) continue;
    traced.shifter.index = own;
    const Shifted first = traced.shifted(p, p + 1);
    traced.shifter.index = later;
    const Shifted second = traced.shifted(p, p + 1);
    EXPECT_EQ(first.result, second.result);
    EXPECT_EQ(first.value, second.value);
    defined += first.result == ShiftResult::defined ? 1 : 0;
  }
  EXPECT_GT(defined, 10);
}

/// A path that is shifted to another pixel and back is itself. The product of both Jacobians is one.
TEST_P(PathShift, IsUndoneByTheShiftBack) {
  const TracedPaths traced = trace();
  Random random(5);
  std::array<int, kShiftResults> results{};
  int pairs = 0;
  int other = 0;
  for (int n = 0; n < 3000; ++n) {
    const auto from = std::min(static_cast<uint32_t>(random.next() * TracedPaths::kPixels), TracedPaths::kPixels - 1);
    const auto to = std::min(static_cast<uint32_t>(random.next() * TracedPaths::kPixels), TracedPaths::kPixels - 1);
    if (!traced.has_path(from) || !traced.records[to].valid()) continue;
    const Shifted there = traced.shifted(from, to);
    ++results[static_cast<size_t>(there.result)];
    EXPECT_EQ(there.result == ShiftResult::defined, there.target > 0.0f);
    EXPECT_EQ(there.target, luminance(there.value));
    if (there.result != ShiftResult::defined) continue;
    ++pairs;
    StoredPath moved = traced.reservoirs[from].sample;
    move_to(there, moved);
    const Shifted itself = traced.shifted(moved, to);
    EXPECT_EQ(itself.value, there.value) << "at rest";
    const Shifted back = traced.shifted(moved, from);
    const Shifted self = traced.shifted(from, from);
    const double jacobian = static_cast<double>(there.density) / static_cast<double>(self.density);
    const double inverse = static_cast<double>(back.density) / static_cast<double>(itself.density);
    const bool equal = back.result == ShiftResult::defined &&
                       difference(back.value, traced.reservoirs[from].sample.value) < 0.01 &&
                       std::fabs(jacobian * inverse - 1) < 1e-4;
    other += equal ? 0 : 1;
  }
  EXPECT_GT(pairs, 100);
  EXPECT_LE(other, 2 + pairs / 100) << "of " << pairs;
  const char* const names[kShiftResults] = {"defined",     "ended",     "too_early", "no_joint",
                                            "other_media", "other_end", "occluded",  "dark"};
  for (size_t i = 0; i < kShiftResults; ++i) RecordProperty(names[i], results[i]);
}

/// Integrand over density is the contribution, so that the weight of a candidate is the sum of all contributions.
TEST_P(PathLuminance, IsThatOfPathTracing) {
  const Case& c = GetParam();
  const TracedPaths traced = trace();
  const CompiledScene scene(find_builtin_scene(c.scene)->build(),
                            {.camera = {}, .width = TracedPaths::kEdge, .height = TracedPaths::kEdge});
  const auto radiance = [&](bool only_specular) {
    std::vector<Rgb> image(TracedPaths::kPixels);
    testing::trace_pixels(
        scene,
        {.width = TracedPaths::kEdge, .height = TracedPaths::kEdge, .max_bounces = 6, .only_specular = only_specular},
        RadianceOutput{mutable_view_of(image)});
    return image;
  };
  const std::vector<Rgb> all = radiance(false);
  const std::vector<Rgb> specular = radiance(true);
  int different = 0;
  for (uint32_t p = 0; p < TracedPaths::kPixels; ++p) {
    const PathReservoir& own = traced.reservoirs[p];
    const float sum = luminance(specular[p]) + luminance(own.sample.value) * own.weight;
    different += std::fabs(sum - luminance(all[p])) < 1e-3f * (0.01f + luminance(all[p])) ? 0 : 1;
  }
  EXPECT_LE(different, static_cast<int>(TracedPaths::kPixels / 100));
}

using enum PathShiftKind;
const Case kFixedChoices[] = {{"reconnection", "cornell", reconnection},
                              {"replay", "cornell", replay},
                              {"hybrid", "cornell", hybrid},
                              {"hybrid_2022", "cornell", hybrid, ConnectRuleKind::distance_2022},
                              {"glass_replay", "cornell-glass", replay},
                              {"glass_hybrid", "cornell-glass", hybrid},
                              {"mirror_hybrid", "cornell-mirror", hybrid},
                              {"mirror_reconnection", "cornell-mirror", reconnection},
                              {"spheres_2022", "cornell-spheres", hybrid, ConnectRuleKind::distance_2022}};
INSTANTIATE_TEST_SUITE_P(Scenes, PathShift, ::testing::ValuesIn(kFixedChoices), case_name);
INSTANTIATE_TEST_SUITE_P(Scenes, PathLuminance, ::testing::ValuesIn(kFixedChoices), case_name);
INSTANTIATE_TEST_SUITE_P(
    Learned, PathShift,
    ::testing::Values(Case{"reconnection", "cornell", reconnection, ConnectRuleKind::footprint, true},
                      Case{"replay", "cornell", replay, ConnectRuleKind::footprint, true},
                      Case{"hybrid", "cornell", hybrid, ConnectRuleKind::footprint, true},
                      Case{"mirror_hybrid", "cornell-mirror", hybrid, ConnectRuleKind::footprint, true},
                      Case{"spheres_2022", "cornell-spheres", hybrid, ConnectRuleKind::distance_2022, true}),
    case_name);

/// Every joint of a shift by reconnection is the second vertex; replay keeps ends by next event estimation only.
TEST(PathJoint, IsWhereTheShiftSays) {
  const Scene scene = find_builtin_scene("cornell")->build();
  const TracedPaths connected(scene, rule_of(reconnection), 6);
  const TracedPaths replayed(scene, rule_of(replay), 6);
  for (uint32_t p = 0; p < TracedPaths::kPixels; ++p) {
    if (connected.has_path(p)) {
      EXPECT_EQ(connected.reservoirs[p].sample.joint(), 1u);
    }
    if (!replayed.has_path(p)) continue;
    const StoredPath& path = replayed.reservoirs[p].sample;
    EXPECT_EQ(path.joint(), path.end() == PathEnd::connection ? path.length() : 0u);
  }
}

/// Over a mirror in view, the second vertex cannot be connected. Later ones must not be, either: that is hybrid.
TEST(PathJoint, IsNeverLaterWithReconnection) {
  const Scene scene = find_builtin_scene("cornell-mirror")->build();
  const TracedPaths traced(scene, rule_of(reconnection), 6);
  const TracedPaths hybrids(scene, rule_of(hybrid), 6);
  int replayed = 0;
  int later = 0;
  const auto is_later = [](const StoredPath& path) { return path.joint() > 1 && path.joint() < path.length(); };
  for (uint32_t p = 0; p < TracedPaths::kPixels; ++p) {
    if (hybrids.has_path(p)) later += is_later(hybrids.reservoirs[p].sample) ? 1 : 0;
    if (!traced.has_path(p)) continue;
    const StoredPath& path = traced.reservoirs[p].sample;
    if (path.joint() == 1) continue;
    ++replayed;
    EXPECT_EQ(path.joint(), path.end() == PathEnd::connection ? path.length() : 0u);
  }
  EXPECT_GT(replayed, 10);
  EXPECT_GT(later, 10);
}

/// Media around all segments are part of integrands.
TEST(PathMedium, IsPartOfTheIntegrand) {
  Scene scene = find_builtin_scene("cornell")->build();
  const TracedPaths clear(scene, rule_of(hybrid), 6);
  testing::add_mesh(scene, testing::tint({0.05f, 0.1f, 0.2f}), box(Vec3(-40), Vec3(40)));
  const TracedPaths traced(scene, rule_of(hybrid), 6);
  int paths = 0;
  int other = 0;
  for (uint32_t p = 0; p < TracedPaths::kPixels; ++p) {
    if (!traced.has_path(p)) continue;
    ++paths;
    const Shifted self = traced.shifted(p, p);
    other +=
        self.result == ShiftResult::defined && difference(self.value, traced.reservoirs[p].sample.value) < 0.01 ? 0 : 1;
  }
  EXPECT_GT(paths, 200);
  EXPECT_LE(other, paths / 100);
}

/// Joints keep the absorption that the path has behind them.
TEST(PathMedium, MustBeTheSameBehindTheJoint) {
  const TracedPaths traced(find_builtin_scene("cornell")->build(), rule_of(reconnection), 6);
  int refused = 0;
  for (uint32_t p = 0; p < TracedPaths::kPixels; ++p) {
    StoredPath path = traced.reservoirs[p].sample;
    if (!traced.has_path(p) || path.joint() == path.length()) continue;
    if (traced.shifted(path, p).result != ShiftResult::defined) continue;
    path.medium = Rgb(0.1f);
    EXPECT_EQ(traced.shifted(path, p).result, ShiftResult::other_media);
    ++refused;
  }
  EXPECT_GT(refused, 50);
}

SegmentEnd random_end(Random& random) {
  return {std::exp(6 * random.next() - 3), random.next() < 0.5f ? 1.0f : random.next(), random.next(),
          random.next() < 0.1f};
}

/// The footprint rule does not depend on the unit of length; the rule by distance does.
TEST(ConnectRule, DependsOnTheScaleOnlyByDistance) {
  Random random(9);
  int differences = 0;
  int connected = 0;
  for (int n = 0; n < 4000; ++n) {
    const SegmentEnd from = random_end(random);
    const SegmentEnd to = random_end(random);
    const float distance = std::exp(8 * random.next() - 5);
    const float primary = primary_footprint(5 * random.next(), random.next());
    const auto connects = [&](ConnectRuleKind kind, float scale) {
      return rule_of(hybrid, kind).connects(from, to, distance * scale, primary * sqr(scale));
    };
    connected += connects(ConnectRuleKind::footprint, 1) ? 1 : 0;
    for (const float scale : {1.0f / 128, 128.0f}) {
      EXPECT_EQ(connects(ConnectRuleKind::footprint, scale), connects(ConnectRuleKind::footprint, 1));
      differences += connects(ConnectRuleKind::distance_2022, scale) != connects(ConnectRuleKind::distance_2022, 1);
    }
  }
  EXPECT_GT(connected, 200);
  EXPECT_LT(connected, 3800);
  EXPECT_GT(differences, 200);
}

TEST(ConnectRule, NeverConnectsDeltaLobes) {
  Random random(13);
  for (int n = 0; n < 1000; ++n) {
    SegmentEnd from = random_end(random);
    SegmentEnd to = random_end(random);
    const float distance = 1 + random.next();
    from.delta = true;
    EXPECT_FALSE(rule_of(reconnection).connects(from, to, distance, 1));
    EXPECT_FALSE(rule_of(reconnection).connects_to_end(from, 1, distance, 1));
    from.delta = false;
    to.delta = true;
    EXPECT_FALSE(rule_of(reconnection).connects(from, to, distance, 1));
    EXPECT_FALSE(rule_of(replay).connects_to_end(from, 1, distance, 1));
  }
}

/// A checkpoint may hold any numbers.
TEST(StoredPath, IsNotUsedIfDamaged) {
  const TracedPaths traced(find_builtin_scene("cornell")->build(), rule_of(hybrid), 6);
  const SceneView& scene = traced.shifter.context.scene;
  uint32_t pixel = 0;
  while (!traced.has_path(pixel) || traced.reservoirs[pixel].sample.joint() == 0) ++pixel;
  const StoredPath path = traced.reservoirs[pixel].sample;
  ASSERT_TRUE(exists(scene, path, 6));
  EXPECT_FALSE(exists(scene, StoredPath{}, 6));
  EXPECT_FALSE(exists(scene, path, path.length() - 1)) << "longer than paths are";
  StoredPath damaged = path;
  damaged.shape = StoredPath::shape_of(path.end(), 2, 3, false);
  EXPECT_FALSE(exists(scene, damaged, 6)) << "a joint after the end";
  damaged.shape = StoredPath::shape_of(PathEnd::cached, 2, 1, false);
  EXPECT_FALSE(exists(scene, damaged, 6)) << "no vertex after the joint";
  for (const uint32_t end : {5u, 6u, 7u}) {
    damaged.shape = StoredPath::shape_of(static_cast<PathEnd>(end), 3, 1, false);
    EXPECT_FALSE(exists(scene, damaged, 6)) << "no such end";
  }
  damaged.shape = StoredPath::shape_of(PathEnd::emitter, 2, 1, false);
  damaged.instance = scene.instances.size;
  EXPECT_FALSE(exists(scene, damaged, 6));
  damaged.shape = StoredPath::shape_of(PathEnd::connection, 1, 1, false);
  damaged.light = scene.lights.lights.size;
  EXPECT_FALSE(exists(scene, damaged, 6));
}

}  // namespace
}  // namespace relume
