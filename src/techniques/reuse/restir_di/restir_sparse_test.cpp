// Tests of the reservoirs of pixels without a path.
#include <algorithm>

#include <gtest/gtest.h>

#include "render/session.h"
#include "techniques/reuse/reservoir/light_point.h"
#include "techniques/reuse/reservoir/testing/fewer_paths.h"
#include "techniques/reuse/restir_di/testing/lamps_over_plate.h"

namespace relume {
namespace {

using testing::StoredReservoirs;

RenderSettings settings_of(int neighbours) {
  RenderSettings settings;
  settings.width = settings.height = 24;
  settings.threads = 1;
  settings.reuse = ReuseChoice::restir_di;
  settings.restir.neighbours = neighbours;
  settings.restir.radius = 6;
  settings.path.max_bounces = 1;
  return settings;
}

PunctualLight brighter_lamp() {
  PunctualLight lamp;
  lamp.type = PunctualType::point;
  lamp.intensity = Rgb(2);
  return lamp;
}

TEST(RestirSparse, PixelsWithoutAPathKeepReservoirsWhileTheSceneRests) {
  RenderSettings settings = settings_of(3);
  settings.upscaling.factor = 2;
  Session session(testing::half_hidden_lamps(), settings);
  testing::expect_reservoirs_to_be_kept<LightPoint>(session, "restir", brighter_lamp());
}

/// A kept reservoir counts as much as in the history of a pixel with a path.
TEST(RestirSparse, TheCapLimitsKeptReservoirs) {
  for (const int cap : {0, 2}) {
    RenderSettings settings = settings_of(3);
    settings.upscaling.factor = 2;
    settings.restir.cap = cap;
    Session session(testing::half_hidden_lamps(), settings);
    float most = 0;
    for (int frame = 0; frame < 9; ++frame) {
      session.render_frame();
      const StoredReservoirs<LightPoint> stored(session, "restir");
      for (size_t p = 0; p < stored.paths.size(); ++p) {
        if (stored.paths[p] == 0) most = std::max(most, stored.reservoirs[p].confidence);
      }
    }
    EXPECT_EQ(most, static_cast<float>(cap));
  }
}

/// The samples that chose the probabilities do not return to the image through reservoirs.
TEST(RestirSparse, ReservoirsEndWithThePilot) {
  RenderSettings settings = settings_of(0);
  settings.allocation = AllocationChoice::adaptive;
  settings.adaptive.pilot = true;
  settings.adaptive.max_samples = 6;
  Session session(testing::half_hidden_lamps(), settings);
  const auto most_confidence = [&] {
    float most = 0;
    for (const auto& reservoir : StoredReservoirs<LightPoint>(session, "restir").reservoirs)
      most = std::max(most, reservoir.confidence);
    return most;
  };
  for (int frame = 0; frame < 6; ++frame) session.render_frame();
  EXPECT_GT(most_confidence(), 3);
  session.render_frame();
  EXPECT_EQ(most_confidence(), 1);
  session.render_frame();
  EXPECT_EQ(most_confidence(), 2);
}

}  // namespace
}  // namespace relume
