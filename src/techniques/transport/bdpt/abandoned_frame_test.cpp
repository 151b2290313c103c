// Frames of bidirectional path tracing that fail or are stopped leave nothing to the next frame.
#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "testing/failing_memory.h"

namespace relume {
namespace {

/// The device's form of kernels keeps light subpaths in arrays.
RenderSettings small_settings(EstimatorChoice estimator, bool scalar_kernels = true) {
  RenderSettings settings;
  settings.width = 24;
  settings.height = 20;
  settings.threads = 2;
  settings.accel = AccelChoice::bvh;
  settings.estimator = estimator;
  settings.scalar_kernels = scalar_kernels;
  return settings;
}

/// The box with a block of glass, which casts a caustic. Each test creates hundreds of sessions, and few triangles
/// keep their acceleration structures cheap.
Scene glass_box() {
  Scene scene = find_builtin_scene("cornell")->build();
  for (Material& material : scene.materials) {
    if (material.name == "boxes") material = glass("boxes", 1.5f, {0.9f, 0.5f, 0.12f}, 1.0f);
  }
  return scene;
}

std::vector<Rgb> next_image(Session& session) {
  EXPECT_TRUE(session.render_frame());
  return session.image().pixels;
}

class AbandonedFrame : public ::testing::TestWithParam<EstimatorChoice> {};

TEST_P(AbandonedFrame, WithoutMemoryLeavesNothing) {
  const RenderSettings settings = small_settings(GetParam());
  Session whole(glass_box(), settings);
  const std::vector<Rgb> expected = next_image(whole);
  testing::FailingMemory memory;
  int before = 0;
  for (bool fails = true; fails; before += fails ? 1 : 0) {
    SCOPED_TRACE(before);
    Session session = make_session(glass_box(), settings, memory);
    memory.fail_after(before);
    try {
      session.render_frame();
    } catch (const std::bad_alloc&) {
      memory.recover();
      EXPECT_EQ(next_image(session), expected);
    }
    memory.recover();
    fails = memory.failed();
  }
  EXPECT_GT(before, 2) << "two arrays of light subpaths";
}

/// Calls `abandon` instead of a tile, for each tile of the first frame in turn, then compares the next frame.
template <typename Abandon>
void expect_same_next_frame(const RenderSettings& settings, const Abandon& abandon) {
  Session whole(glass_box(), settings);
  const std::vector<Rgb> expected = next_image(whole);
  int abandoned = 0;
  for (int before = 0;; ++before) {
    SCOPED_TRACE(before);
    Session session(glass_box(), settings);
    std::atomic<int> tiles = 0;
    std::stop_source stop;
    on_tile(session, [&] {
      if (tiles++ == before) abandon(stop);
    });
    bool complete = false;
    try {
      complete = session.render_frame(stop.get_token());
    } catch (const std::runtime_error&) {
    }
    on_tile(session, {});
    if (complete && tiles <= before) break;
    if (complete) continue;  // a stop came too late for the frame
    ++abandoned;
    EXPECT_EQ(next_image(session), expected);
  }
  EXPECT_GT(abandoned, 4) << "four tiles are traced";
}

TEST_P(AbandonedFrame, ThatThrowsLeavesNothing) {
  for (const bool scalar_kernels : {false, true}) {
    expect_same_next_frame(small_settings(GetParam(), scalar_kernels),
                           [](std::stop_source&) { throw std::runtime_error("a tile"); });
  }
}

TEST_P(AbandonedFrame, ThatIsStoppedLeavesNothing) {
  expect_same_next_frame(small_settings(GetParam()), [](std::stop_source& stop) { stop.request_stop(); });
}

TEST_P(AbandonedFrame, DoesNotCountForWarnings) {
  Scene bright = find_builtin_scene("cornell")->build();
  for (Material& material : bright.materials) material.emission *= 1e12f;
  Session session(bright, small_settings(GetParam()));
  session.on_pass([](const std::string& pass) {
    if (pass == "trace") throw std::runtime_error("after the pass");
  });
  EXPECT_THROW(session.render_frame(), std::runtime_error);
  EXPECT_TRUE(session.warnings().empty());
  session.on_pass({});
  session.render_frame();
  const std::vector<std::string> once = session.warnings();
  Session whole(bright, small_settings(GetParam()));
  whole.render_frame();
  EXPECT_EQ(once, whole.warnings());
  EXPECT_FALSE(once.empty());
}

std::string estimator_name(const ::testing::TestParamInfo<EstimatorChoice>& info) {
  switch (info.param) {
    case EstimatorChoice::path: break;
    case EstimatorChoice::bdpt: return "bdpt";
    case EstimatorChoice::light: return "light";
    case EstimatorChoice::vcm: return "vcm";
  }
  return "path";
}
INSTANTIATE_TEST_SUITE_P(Bdpt, AbandonedFrame,
                         ::testing::Values(EstimatorChoice::bdpt, EstimatorChoice::light, EstimatorChoice::vcm),
                         estimator_name);

}  // namespace
}  // namespace relume
