// Records of data structures, and buffers that hooks edit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "relume/builtin_scenes.h"
#include "relume/error.h"
#include "relume/session.h"

namespace relume {
namespace {

Settings small(const std::vector<std::pair<std::string, std::string>>& values, int threads = 1) {
  Settings settings;
  settings.set("width", 48).set("height", 32).set("threads", threads);
  for (const auto& [name, value] : values) settings.set(name, value);
  return settings;
}

Session rendered(const std::string& scene, const Settings& settings, int frames = 3) {
  Session session(builtin_scene(scene), settings);
  for (int i = 0; i < frames; ++i) session.render_frame();
  return session;
}

/// Component `i` of a field of record `record`.
template <typename T>
T value(const RecordData& data, size_t record, const std::string& field, size_t i = 0) {
  for (const RecordField& f : data.table.fields) {
    if (f.name != field) continue;
    T result;
    std::memcpy(&result, data.bytes.data() + record * data.table.stride + f.offset + i * sizeof(T), sizeof(T));
    return result;
  }
  ADD_FAILURE() << "no field " << field;
  return {};
}

double statistic(const Session& session, const std::string& name) {
  for (const PassStatistic& s : session.statistics().pass_statistics) {
    if (s.name == name) return s.value;
  }
  ADD_FAILURE() << "no statistic " << name;
  return 0;
}

const std::vector<std::pair<std::string, std::string>> kLearning = {{"lights", "vlc"}, {"guide", "cdq"}};

TEST(SessionRecords, LeavesOfTheOctreeFillTheCube) {
  const Session session = rendered("warehouse", small(kLearning));
  const RecordData leaves = session.records("octree.leaves");
  ASSERT_EQ(static_cast<double>(leaves.size()), statistic(session, "octree.leaves"));
  double volume = 0;
  Vec3 low(kInfinity);
  Vec3 high(-kInfinity);
  for (size_t i = 0; i < leaves.size(); ++i) {
    const auto edge = value<float>(leaves, i, "edge");
    volume += std::pow(static_cast<double>(edge), 3);
    const Vec3 corner(value<float>(leaves, i, "corner", 0), value<float>(leaves, i, "corner", 1),
                      value<float>(leaves, i, "corner", 2));
    low = glm::min(low, corner);
    high = glm::max(high, corner + edge);
  }
  const Vec3 extent = high - low;
  EXPECT_NEAR(volume, static_cast<double>(extent.x) * extent.y * extent.z, 1e-4 * volume);
}

TEST(SessionRecords, LeavesOfEveryQuadtreeFillTheSquare) {
  const Session session = rendered("cornell", small(kLearning));
  const RecordData leaves = session.records("cdq.leaves");
  std::map<uint32_t, double> areas;
  for (size_t i = 0; i < leaves.size(); ++i)
    areas[value<uint32_t>(leaves, i, "region")] += std::pow(static_cast<double>(value<float>(leaves, i, "edge")), 2);
  EXPECT_EQ(areas.size(), session.records("octree.leaves").size());
  for (const auto& [region, area] : areas) EXPECT_DOUBLE_EQ(area, 1) << region;
}

TEST(SessionRecords, ListsLightsByRegion) {
  const Session session = rendered("warehouse", small(kLearning));
  const RecordData lights = session.records("vlc.lights");
  ASSERT_GT(lights.size(), 0u);
  const double expected = statistic(session, "vlc.lights-a-region") * statistic(session, "vlc.regions");
  EXPECT_NEAR(static_cast<double>(lights.size()), expected, 0.5);
  const RecordData complete =
      rendered("warehouse", small({{"lights", "static-lists"}}), 1).records("static-lists.lights");
  EXPECT_GT(complete.size(), 256u) << "each bay sees its own lamp";
}

TEST(SessionRecords, CellsAreTheSameOnAnyNumberOfThreads) {
  const Session one = rendered("cornell", small({{"cache", "psf"}}, 1));
  const Session three = rendered("cornell", small({{"cache", "psf"}}, 3));
  const RecordData cells = one.records("cells.cells");
  EXPECT_EQ(static_cast<double>(cells.size()), statistic(one, "cells.cells"));
  EXPECT_EQ(cells.bytes, three.records("cells.cells").bytes);
  for (size_t i = 0; i < cells.size(); ++i) EXPECT_GT(value<float>(cells, i, "samples"), 0.0f);
}

TEST(SessionRecords, HooksReplaceTheImageOfAFrame) {
  Session session(builtin_scene("cornell"), small({}));
  const Image white = [] {
    Image image(48, 32);
    std::fill(image.pixels.begin(), image.pixels.end(), Rgb(1));
    return image;
  }();
  session.on_pass([&](const std::string& pass) {
    if (pass == "accumulate") session.replace_image(white);
  });
  session.render_frame();
  EXPECT_EQ(session.image().pixels, white.pixels);
  session.on_pass({});
  session.render_frame();
  EXPECT_EQ(session.image().pixels, rendered("cornell", small({}), 2).image().pixels);
  EXPECT_THROW(session.replace_image(Image(8, 8)), Error);
}

TEST(SessionRecords, ReplacedImagesBelongToCompleteFrames) {
  Session session = rendered("cornell", small({}), 2);
  const Image black(48, 32);
  session.on_pass([&](const std::string& pass) {
    if (pass != "accumulate") return;
    session.replace_image(black);
    throw Error("the hook failed");
  });
  EXPECT_THROW(session.render_frame(), Error);
  EXPECT_NE(session.image().pixels, black.pixels);
}

TEST(SessionRecords, HooksCannotChangeTheSession) {
  Session session(builtin_scene("cornell"), small({}));
  const std::vector<std::function<void()>> changes = {
      [&] { session.set_camera(session.camera()); },
      [&] { session.set_material(0, Material()); },
      [&] { session.set_environment({}); },
      [&] { session.set_time(1); },
      [&] { session.add_material({}); },
      [&] { session.restart(1); },
      [&] { session.set_settings(small({}, 2)); },
      [&] { session.begin_image(); },
      [&] { session.render_frame(); },
      [&] { session.load_checkpoint("none"); },
  };
  int refused = 0;
  session.on_pass([&](const std::string& pass) {
    if (pass != "trace") return;
    for (const auto& change : changes) {
      try {
        change();
      } catch (const Error&) {
        ++refused;
      }
    }
  });
  session.render_frame();
  EXPECT_EQ(refused, static_cast<int>(changes.size()));
  EXPECT_EQ(session.image().pixels, rendered("cornell", small({}), 1).image().pixels);
}

TEST(SessionRecords, UnknownTablesAreErrors) {
  const Session session = rendered("cornell", small({}), 1);
  EXPECT_TRUE(session.record_tables().empty());
  EXPECT_THROW(session.records("octree.leaves"), Error);
}

TEST(SessionRecords, HooksEditBuffersBetweenPasses) {
  const Settings settings = small({});
  const Image before = rendered("cornell", settings, 2).image();
  Session session(builtin_scene("cornell"), settings);
  const std::vector<PassInfo> passes = session.passes();
  const auto trace =
      std::find_if(passes.begin(), passes.end(), [](const PassInfo& pass) { return pass.name == "trace"; });
  ASSERT_NE(trace, passes.end());
  EXPECT_EQ(trace->stage, "trace");
  session.on_pass([&](const std::string& pass) {
    if (pass != "trace") return;
    const std::span<std::byte> bytes = session.edit_buffer("radiance");
    auto* values = reinterpret_cast<float*>(bytes.data());
    for (size_t i = 0; i < bytes.size() / sizeof(float); ++i) values[i] *= 2;
  });
  session.render_frame();
  session.render_frame();
  const Image after = session.image();
  for (size_t i = 0; i < before.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(after.pixels[i][c], 2 * before.pixels[i][c]);
  }
  try {
    session.edit_buffer("sample");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::not_found);
    EXPECT_STREQ(error.what(), "there is no buffer 'sample' with these settings; did you mean 'samples'?");
  }
}

TEST(BuiltinScenes, UnknownNamesSuggestTheNearest) {
  EXPECT_GT(list_builtin_scenes().size(), 10u);
  try {
    builtin_scene("cornel");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::not_found);
    EXPECT_STREQ(error.what(), "there is no built-in scene 'cornel'; did you mean 'cornell'?");
  }
}

}  // namespace
}  // namespace relume
