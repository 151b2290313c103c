// Orthographic cameras with a lens, which pbrt renders in perspective.
#include "scene_io/pbrt/pbrt_loader.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "relume/scene_io.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

Scene with_camera(const std::string& lens) {
  return load_pbrt_from_memory(
      testing::to_bytes("Film \"rgb\" \"integer xresolution\" 300 \"integer yresolution\" 200\n"
                        "Camera \"orthographic\" \"float screenwindow\" [-3 3 -2 2] " +
                        lens + "\nWorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 9 1 0 9 0 1 9]\n"),
      "/nonexistent", "a.pbrt");
}

TEST(PbrtCamera, OrthographicCamerasWithALensSeeInPerspective) {
  const Scene scene = with_camera("\"float lensradius\" 0.25 \"float focaldistance\" 4");
  EXPECT_TRUE(testing::mentions(scene.warnings, "an orthographic camera with a lens"));
  const testing::SceneFolder folder;
  const auto file = folder.path() / "out.pbrt";
  write_pbrt(file, scene);
  for (const Scene& loaded : {scene, load_scene(file)}) {
    const Camera& camera = loaded.cameras.at(0);
    EXPECT_EQ(camera.projection, Projection::perspective);
    EXPECT_NEAR(camera.fov_y_rad, 2 * std::atan(2.0f / 4), 1e-5f);  // the window is at the focus distance
    EXPECT_EQ(camera.lens_radius, 0.25f);
    EXPECT_EQ(camera.focus_distance, 4);
  }
}

TEST(PbrtCamera, OrthographicCamerasWithoutALensIgnoreTheFocusDistance) {
  const Scene scene = with_camera("\"float focaldistance\" 4");
  EXPECT_EQ(scene.cameras.at(0).projection, Projection::orthographic);
  EXPECT_EQ(scene.cameras[0].half_height, 2);
  EXPECT_FALSE(testing::mentions(scene.warnings, "orthographic"));
}

}  // namespace
}  // namespace relume
