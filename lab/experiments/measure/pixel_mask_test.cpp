#include "experiments/measure/pixel_mask.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/trigonometric.hpp>

#include "experiments/measure/learning_regions.h"
#include "experiments/setup/learning_scenes.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"

namespace relume {
namespace {

TEST(PixelMasks, AreMadeFromRectangles) {
  const PixelMask mask = mask_of({"middle", 0.25, 0, 0.75, 0.5}, 4, 2);
  EXPECT_EQ(mask.name, "middle");
  EXPECT_EQ(mask.mask, (std::vector<uint8_t>{0, 1, 1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(mask.pixels(), 2u);
  EXPECT_EQ(mask_of({"beyond", -1, 0.5, 2, 3}, 4, 2).mask, (std::vector<uint8_t>{0, 0, 0, 0, 1, 1, 1, 1}));
}

TEST(PixelMasks, CountsThePixelsOfARegionOnly) {
  Image reference(2, 1);
  Image frame(2, 1);
  frame.pixels = {Rgb(1, 2, 3), Rgb(30)};
  EXPECT_DOUBLE_EQ(frame_mse(frame, reference, {"left", {1, 0}}), (1.0 + 4 + 9) / 3);
  EXPECT_DOUBLE_EQ(frame_mse(frame, reference, mask_of({"image"}, 2, 1)), (1.0 + 4 + 9 + 2700) / 6);
}

TEST(PixelMasks, TheReferencesNoiseIsThatOfTheRegion) {
  Reference reference;
  EXPECT_EQ(reference_noise(reference, mask_of({"image"}, 2, 1)), 0);
  reference.squared_error = Image(2, 1);
  reference.squared_error.pixels = {Rgb(1, 2, 3), Rgb(30)};
  EXPECT_DOUBLE_EQ(reference_noise(reference, {"left", {1, 0}}), 2);
  EXPECT_DOUBLE_EQ(reference_noise(reference, mask_of({"image"}, 2, 1)), 16);
}

TEST(PixelMasks, SeparateTheMinesRegions) {
  Image reference(4, 1);
  Image direct(4, 1);
  direct.pixels = {Rgb(10), Rgb(0.1f), Rgb(0), Rgb(500)};  // sky last
  reference.pixels = {Rgb(11), Rgb(3), Rgb(0), Rgb(500)};
  const std::vector<PixelMask> regions = mine_regions(reference, direct, {"surfaces", {1, 1, 1, 0}});
  ASSERT_EQ(regions.size(), 4u);
  EXPECT_EQ(regions[1].mask, (std::vector<uint8_t>{1, 0, 0, 0}));
  EXPECT_EQ(regions[2].mask, (std::vector<uint8_t>{0, 1, 0, 0}));
  EXPECT_EQ(regions[3].mask, (std::vector<uint8_t>{0, 0, 1, 0}));
}

/// The camera stands at the origin and looks along -Z. The outer columns show walls of the neighbours.
TEST(PixelMasks, KeepWhatIsInARoom) {
  Reference reference;
  reference.image = Image(3, 1);
  CameraPose camera;
  camera.camera.fov_y_rad = glm::radians(90.0f);
  const BaseRoom room{{-2, -4}, {2, 1}};
  const PixelMask all{"all", {1, 1, 1}};
  const auto inside = [&](std::vector<float> depths, const PixelMask& region) {
    reference.surface.depth = std::move(depths);
    return pixels_in_room(region, reference, camera, room).mask;
  };
  // The outer rays reach x = ±2 after √5 m, the middle one z = -4 after 4 m.
  EXPECT_EQ(inside({2.2f, 3.9f, 2.2f}, all), (std::vector<uint8_t>{1, 1, 1}));
  EXPECT_EQ(inside({2.3f, 4.1f, 2.2f}, all), (std::vector<uint8_t>{0, 0, 1}));
  EXPECT_EQ(inside({2.2361f, 4.001f, 2.2361f}, all), (std::vector<uint8_t>{1, 1, 1})) << "walls in the room's faces";
  EXPECT_EQ(inside({2.2f, 3.9f, 2.2f}, {"left", {1, 0, 0}}), (std::vector<uint8_t>{1, 0, 0}));
  EXPECT_EQ(inside({2.2f, 0, 2.2f}, all), (std::vector<uint8_t>{1, 0, 1})) << "nothing is visible";
}

/// The camera of `turntable-spot` sees the floor in the middle of the image, and the wall at its border.
TEST(PixelMasks, ShowOneMaterial) {
  const TempFolder folder;
  ExperimentContext context;
  context.quick = true;
  context.cache_folder = folder / "references";
  const ExperimentScene scene = learning_scene("turntable-spot");
  const PixelMask floor = pixels_of_material(context, scene, "floor");
  ASSERT_EQ(floor.mask.size(), 32u * 18);
  EXPECT_EQ(floor.name, "floor");
  EXPECT_EQ(floor.mask[9 * 32 + 16], 1);
  EXPECT_EQ(floor.mask[0], 0);
  EXPECT_EQ(floor.mask[17 * 32 + 31], 0);
  EXPECT_GT(floor.pixels(), 40u);
  EXPECT_LT(floor.pixels(), 150u);
  EXPECT_THROW(pixels_of_material(context, scene, "no such material"), Error);
}

}  // namespace
}  // namespace relume
