#include "viewer/model/camera_path.h"

#include <gtest/gtest.h>

#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "scene/scene.h"

namespace relume::viewer {
namespace {

TEST(CameraPath, IsLinearBetweenKeysAndStillOutside) {
  CameraPath path;
  path.add({0, {0, 0, 0}, {1, 0, 0, 0}});
  path.add({2, {4, 0, 0}, {1, 0, 0, 0}});
  path.add({2, {9, 9, 9}, {1, 0, 0, 0}});  // not later
  EXPECT_EQ(path.keys().size(), 2u);
  EXPECT_FLOAT_EQ(path.at(0.5f).eye.x, 1);
  EXPECT_FLOAT_EQ(path.at(-1).eye.x, 0);
  EXPECT_FLOAT_EQ(path.at(7).eye.x, 4);
  EXPECT_FLOAT_EQ(path.duration_s(), 2);
}

TEST(CameraPath, TurnsAtAnEvenRate) {
  const Transform from = look_at({0, 0, 0}, {0, 0, -1});
  const Transform to = look_at({0, 0, 0}, {1, 0, 0});
  CameraPath path;
  path.add({0, {}, from.rotation});
  path.add({1, {}, to.rotation});
  const Vec3 forward = path.at(0.5f).rotation * Vec3(0, 0, -1);
  EXPECT_NEAR(forward.x, std::sqrt(0.5f), 1e-5f);
  EXPECT_NEAR(forward.z, -std::sqrt(0.5f), 1e-5f);
}

TEST(Bookmarks, RoundTripThroughTheirFile) {
  const TempFolder folder;
  const std::filesystem::path file = folder / "deep/bookmarks.json";
  EXPECT_TRUE(read_bookmarks(file).empty());
  const Transform t = look_at({1, 2, 3}, {4, 5, 6});
  write_bookmarks(file, {{"View 1", {t.translation, t.rotation, 0.7f}}});
  const std::vector<Bookmark> read = read_bookmarks(file);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].name, "View 1");
  EXPECT_EQ(read[0].view.eye, t.translation);
  EXPECT_NEAR(glm::dot(read[0].view.rotation, t.rotation), 1, 1e-6f);
  EXPECT_FLOAT_EQ(read[0].view.fov_y_rad, 0.7f);
}

TEST(Bookmarks, RefuseOtherFiles) {
  const TempFolder folder;
  const std::filesystem::path file = folder / "b.json";
  for (const char* text :
       {"", "[]", "{}", R"({"bookmarks": [{"name": "x"}]})",
        R"({"bookmarks": [{"name": "x", "eye": [0,0,0], "rotation": [0,0,0,0], "fov_y_rad": 1}]})"}) {
    write_file(file, text);
    EXPECT_THROW(read_bookmarks(file), Error) << text;
  }
}

}  // namespace
}  // namespace relume::viewer
