#include "techniques/reuse/restir_gi/indirect_image.h"

#include <limits>

#include <gtest/gtest.h>

#include "scene/compiled_scene.h"
#include "scene/testing/media.h"

namespace relume {
namespace {

constexpr uint32_t kEdge = 4;
constexpr int kChoices = 1000;

/// A glossy surface point, which reflects each direction with another colour.
class AddToRecord : public ::testing::Test {
 protected:
  AddToRecord() {
    Sampler sampler = SampleIndex{.seed = 7, .sample = 3}.sampler(1, 1);
    const SceneView& view = scene_.view();
    const Sampler of_path = sampler;
    const Ray ray = lone_camera_ray(view.camera, 1, 1, sampler);
    const Hit hit = intersect_from_camera(view.accel, ray, of_path.camera_ray_id());
    make_receiver(view, record_of(view, 1, 1, of_path, hit), receiver_);
    a_ = sp().frame.to_world(glm::normalize(Vec3(0.1f, 0.2f, 1)));
    b_ = sp().frame.to_world(glm::normalize(Vec3(-0.8f, 0.3f, 0.5f)));
  }

  static Scene glossy_plate() {
    Material material = testing::matte(Rgb(0.2f, 0.5f, 0.8f));
    material.specular = 1;
    material.roughness = 0.5f;
    return testing::plate(material, 3, 1);
  }

  const SurfacePoint& sp() const { return receiver_.sp; }
  /// Luminance of the reflected light.
  float reflected(const Vec3& wi, const Rgb& arriving) const { return luminance(eval_pdf(sp(), wi).f * arriving); }
  FirstVertex record_of_a(const Rgb& arriving) const {
    FirstVertex vertex;
    vertex.scatter = a_;
    vertex.indirect = arriving;
    return vertex;
  }

  const CompiledScene scene_{glossy_plate(), CompileOptions{.camera = {}, .width = kEdge, .height = kEdge}};
  Receiver receiver_;
  Vec3 a_{0};
  Vec3 b_{0};
};

TEST_F(AddToRecord, TheMeanHasTheLightOfBothDirections) {
  const Rgb from_a(3, 1, 2);
  const Rgb from_b(1, 3, 4);
  const float share = reflected(b_, from_b) / (reflected(a_, from_a) + reflected(b_, from_b));
  ASSERT_GT(share, 0.2f);
  ASSERT_LT(share, 0.8f);
  int of_b = 0;
  Rgb mean_a(0);
  Rgb mean_b(0);
  for (int i = 0; i < kChoices; ++i) {
    FirstVertex vertex = record_of_a(from_a);
    add_to_record(sp(), b_, from_b, (static_cast<float>(i) + 0.5f) / kChoices, vertex.scatter, vertex.indirect);
    ASSERT_TRUE(vertex.scatter == a_ || vertex.scatter == b_);
    const float both = reflected(a_, from_a) + reflected(b_, from_b);
    ASSERT_NEAR(reflected(vertex.scatter, vertex.indirect), both, 1e-4f * both);
    (vertex.scatter == b_ ? mean_b : mean_a) += vertex.indirect / static_cast<float>(kChoices);
    of_b += vertex.scatter == b_ ? 1 : 0;
  }
  EXPECT_NEAR(of_b, share * kChoices, 1.5f);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean_a[c], from_a[c], 0.01f * from_a[c]);
    EXPECT_NEAR(mean_b[c], from_b[c], 0.01f * from_b[c]);
  }
}

TEST_F(AddToRecord, ReplacesADirectionWithoutLight) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Rgb& before : {Rgb(0), Rgb(nan), Rgb(kInfinity)}) {
    FirstVertex vertex = record_of_a(before);
    add_to_record(sp(), b_, Rgb(2), 0.99f, vertex.scatter, vertex.indirect);
    EXPECT_EQ(vertex.scatter, b_);
    EXPECT_EQ(vertex.indirect, Rgb(2));
  }
}

TEST_F(AddToRecord, IgnoresADirectionWithoutLight) {
  const Vec3 below = -sp().ng;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  FirstVertex vertex = record_of_a(Rgb(2));
  add_to_record(sp(), b_, Rgb(0), 0.0f, vertex.scatter, vertex.indirect);
  add_to_record(sp(), b_, Rgb(nan), 0.0f, vertex.scatter, vertex.indirect);
  add_to_record(sp(), b_, Rgb(kInfinity), 0.0f, vertex.scatter, vertex.indirect);
  add_to_record(sp(), below, Rgb(1), 0.0f, vertex.scatter, vertex.indirect);
  EXPECT_EQ(vertex.scatter, a_);
  EXPECT_EQ(vertex.indirect, Rgb(2));
}

}  // namespace
}  // namespace relume
