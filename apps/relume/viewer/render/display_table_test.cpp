#include "viewer/render/display_table.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "core/srgb.h"
#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "framebuffer/ocio_view.h"
#include "framebuffer/tone_map.h"
#include "relume/image.h"
#include "testing/random.h"

namespace relume::viewer {
namespace {

/// ACES 1.0 on an sRGB display, and a view without a curve.
constexpr const char* kConfig = R"(ocio_profile_version: 2
roles: {default: raw, scene_linear: aces}
displays:
  sRGB:
    - !<View> {name: SDR, view_transform: SDR, display_colorspace: sRGB}
    - !<View> {name: Half, colorspace: half}
active_displays: []
active_views: []
view_transforms:
  - !<ViewTransform>
    name: SDR
    from_scene_reference: !<BuiltinTransform> {style: ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0}
display_colorspaces:
  - !<ColorSpace>
    name: sRGB
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}
colorspaces:
  - !<ColorSpace> {name: raw, isdata: true}
  - !<ColorSpace> {name: aces}
  - !<ColorSpace>
    name: lin_rec709
    from_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1, direction: inverse}
        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD}
  - !<ColorSpace>
    name: half
    from_scene_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}
)";

/// Looks up the table like the shader.
Rgb look_up(const DisplayTable& table, const Rgb& radiance) {
  std::array<int, 3> cell{};
  Vec3 share;
  for (int c = 0; c < 3; ++c) {
    const float t = saturate((std::log2(max(radiance[c], 1e-9f)) - kTableMinEv) / (kTableMaxEv - kTableMinEv));
    const float at = t * static_cast<float>(table.size - 1);
    cell[static_cast<size_t>(c)] = std::min(static_cast<int>(at), table.size - 2);
    share[c] = at - static_cast<float>(cell[static_cast<size_t>(c)]);
  }
  Rgb sum(0);
  for (int corner = 0; corner < 8; ++corner) {
    float weight = 1;
    int index = 0;
    for (int c = 2; c >= 0; --c) {
      const int bit = corner >> c & 1;
      weight *= bit == 1 ? share[c] : 1 - share[c];
      index = index * table.size + cell[static_cast<size_t>(c)] + bit;
    }
    sum += weight * table.colors[static_cast<size_t>(index)];
  }
  return sum;
}

/// Channels from 2^-10 to 2^6, in equal numbers per stop.
Image radiances() {
  Image image(64, 256);
  relume::testing::Random random(7);
  for (Rgb& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) pixel[c] = std::exp2(-10 + 16 * random.next());
  }
  return image;
}

struct Errors {
  float mean = 0;
  float share = 0;  ///< share of pixels with a difference above one step
};

/// Errors in steps of 1/255; `exact` is display-linear.
Errors errors_of(const DisplayTable& table, const Image& radiance, const Image& exact) {
  Errors errors;
  for (size_t i = 0; i < radiance.pixels.size(); ++i) {
    const Rgb difference = look_up(table, radiance.pixels[i]) - srgb_from_linear(exact.pixels[i]);
    const float error = 255 * max_component(abs(difference));
    errors.mean += error / static_cast<float>(radiance.pixels.size());
    if (error > 1) errors.share += 1 / static_cast<float>(radiance.pixels.size());
  }
  return errors;
}

TEST(DisplayTable, IsCloseToTheToneMaps) {
  const Image radiance = radiances();
  for (const ToneMap tone_map : {ToneMap::agx, ToneMap::aces, ToneMap::reinhard}) {
    Image exact = radiance;
    for (Rgb& pixel : exact.pixels) pixel = relume::tone_map(tone_map, 0, pixel);
    const Errors errors = errors_of(display_table(tone_map), radiance, exact);
    EXPECT_LT(errors.mean, 0.5f) << static_cast<int>(tone_map);
    EXPECT_LT(errors.share, 0.1f) << static_cast<int>(tone_map);
  }
}

TEST(DisplayTable, IsCloseToOpenColorIOViews) {
  if (!ocio_missing().empty()) GTEST_SKIP() << ocio_missing();
  const TempFolder folder;
  write_file(folder / "config.ocio", kConfig);
  const Image radiance = radiances();
  for (const char* name : {"SDR", "Half"}) {
    const OcioView view((folder / "config.ocio").string(), name);
    const Errors errors = errors_of(display_table(view), radiance, view.apply(radiance, 0));
    EXPECT_LT(errors.mean, 0.5f) << name;
    EXPECT_LT(errors.share, 0.07f) << name;
  }
}

TEST(DisplayTable, OpenColorIOTablesAreComputedInTheBackground) {
  const OcioDisplay tone_map(nullptr);
  EXPECT_TRUE(tone_map.ready());
  EXPECT_EQ(tone_map.table(), nullptr);
  if (!ocio_missing().empty()) GTEST_SKIP() << ocio_missing();
  const TempFolder folder;
  write_file(folder / "config.ocio", kConfig);
  const auto view = std::make_shared<const OcioView>((folder / "config.ocio").string(), "Half");
  const OcioDisplay display(view);
  EXPECT_EQ(display.view(), view);
  const DisplayTable* table = display.table();
  EXPECT_TRUE(display.ready());
  EXPECT_EQ(table, display.table()) << "it is uploaded once";
  EXPECT_EQ(table->colors, display_table(*view).colors);
}

}  // namespace
}  // namespace relume::viewer
