// Both acceleration structures with an open shutter: hits against an exhaustive search in the scene posed at the time
// of the ray, and of one structure against the other.
#include "accel/bvh/timed_instance.h"

#include <cmath>
#include <deque>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "accel/bvh/bvh_accel.h"
#include "accel/embree_accel.h"
#include "accel/testing/exhaustive_rays.h"

namespace relume {
namespace {

using testing::corners_of;
using testing::expect_exhaustive_hit;
using testing::kRayId;
using testing::Random;
using testing::random_triangles;
using testing::ray_through;
using testing::Soup;

constexpr uint32_t kKeys = 5;
constexpr float kExtent = 6;

/// Triangles that turn, stretch and move while the shutter is open, others whose corners move, in world space and as an
/// instance that turns too, and a wall at rest.
class TimedSoup {
 public:
  explicit TimedSoup(uint32_t seed) : random_(seed) {
    const uint32_t rigid = soup.add_mesh(random_triangles(random_, 60, 1.5f, 0.6f));
    for (int i = 0; i < 6; ++i) add_turning(rigid);
    add_deforming();
    const auto shape = static_cast<uint32_t>(soup.meshes.size() - 1);
    soup.add_instance(shape);
    add_turning(shape);
    soup.add_instance(soup.add_mesh({Vec3(-9, -9, -5), Vec3(9, -9, -5), Vec3(0, 9, -5)}));
  }

  /// The scene at a time, at rest.
  Soup posed_at(float time) const {
    Soup posed;
    for (const AccelMesh& mesh : soup.meshes) {
      std::vector<Vec3> corners;
      for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
        const TriangleCorners c = relume::corners_at(mesh, t, time);
        corners.insert(corners.end(), {c.p0, c.p1, c.p2});
      }
      AccelMesh& copy = posed.meshes[posed.add_mesh(corners)];
      copy.culls_back_faces = mesh.culls_back_faces;
    }
    for (const AccelInstance& instance : soup.instances) {
      AccelInstance& copy = posed.instances.emplace_back(instance);
      copy.to_world = to_world_at(instance, time);
      copy.keys = nullptr;
      copy.key_count = 0;
    }
    return posed;
  }

  std::vector<AccelMeshKeys> mesh_keys() const {
    const size_t count = vertex_keys_.size() / kKeys;
    return {{.mesh = 1,
             .positions = &vertex_keys_[0].x,
             .stride = count * sizeof(Vec3),
             .vertex_count = count,
             .count = kKeys}};
  }

  Soup soup;

 private:
  void add_turning(uint32_t mesh) {
    const Vec3 axis = random_.direction();
    const Vec3 from = random_.point(-4, 4);
    const Vec3 by = random_.point(-2, 2);
    const float turn = random_.uniform(0.2f, 2);
    std::vector<Mat4>& keys = matrices_.emplace_back();
    for (uint32_t k = 0; k < kKeys; ++k) {
      const float t = static_cast<float>(k) / (kKeys - 1);
      const Mat4 turned = glm::rotate(glm::translate(Mat4(1), from + by * (t * t)), turn * t, axis);
      keys.push_back(glm::scale(turned, Vec3(1 + t, 1, 1 - 0.5f * t)));
    }
    soup.add_instance(mesh, keys[kKeys / 2]);
    soup.instances.back().moves = true;
    soup.instances.back().keys = keys.data();
    soup.instances.back().key_count = kKeys;
  }

  void add_deforming() {
    const std::vector<Vec3> rest = random_triangles(random_, 60, 2, 0.6f);
    std::vector<Vec3> by;
    for (size_t i = 0; i < rest.size(); ++i) by.push_back(random_.point(-1, 1));
    for (uint32_t k = 0; k < kKeys; ++k) {
      const float t = static_cast<float>(k) / (kKeys - 1);
      for (size_t i = 0; i < rest.size(); ++i) vertex_keys_.push_back(rest[i] + by[i] * std::sin(4 * t));
    }
    const size_t middle = kKeys / 2 * rest.size();
    const auto first = vertex_keys_.begin() + static_cast<ptrdiff_t>(middle);
    soup.add_mesh(std::vector<Vec3>(first, first + static_cast<ptrdiff_t>(rest.size())));
    soup.meshes.back().deforms = true;
    vertex_keys_.reserve(vertex_keys_.size() + 1);  // Embree reads 16 bytes at the last vertex
    assign_keys(soup.meshes, mesh_keys());
  }

  Random random_;
  std::deque<std::vector<Mat4>> matrices_;
  std::vector<Vec3> vertex_keys_;
};

template <typename Accel>
void open_shutter(Accel& accel, const TimedSoup& timed) {
  const uint32_t deforming = 1;
  accel.set_keys(timed.mesh_keys());
  accel.update(timed.soup.instances, {&deforming, 1});
}

/// The scene with all keys removed: where it rests in the middle.
Soup closed(const TimedSoup& timed) {
  Soup soup = timed.posed_at(kShutterMiddle);
  for (uint32_t m = 0; m < soup.meshes.size(); ++m) soup.meshes[m].deforms = timed.soup.meshes[m].deforms;
  return soup;
}

TEST(TimedInstances, NoRayMissesWhatAnExhaustiveSearchFinds) {
  for (uint32_t seed = 1; seed <= 3; ++seed) {
    const TimedSoup timed(seed);
    BvhAccel accel(timed.soup.meshes, timed.soup.instances, timed.soup.opacity);
    open_shutter(accel, timed);
    Random random(100 + seed);
    for (const float time : {0.0f, 0.13f, 0.25f, 0.5f, 0.62f, 0.999f, 1.0f}) {
      const Soup posed = timed.posed_at(time);
      const std::vector<Vec3> corners = corners_of(posed);
      for (int i = 0; i < 400; ++i) {
        Ray ray = ray_through(random, corners, kExtent);
        ray.time = time;
        ASSERT_NO_FATAL_FAILURE(expect_exhaustive_hit(posed, accel.view(), ray)) << time << ", ray " << i;
      }
    }
  }
}

TEST(TimedInstances, TheMiddleIsThePoseOfTheFrame) {
  const TimedSoup timed(4);
  BvhAccel open(timed.soup.meshes, timed.soup.instances, timed.soup.opacity);
  open_shutter(open, timed);
  const Soup rest = closed(timed);
  const BvhAccel shut(rest.meshes, rest.instances, rest.opacity);
  Random random(5);
  const std::vector<Vec3> corners = corners_of(rest);
  for (int i = 0; i < 2000; ++i) {
    const Ray ray = ray_through(random, corners, kExtent);
    const Hit a = intersect(open.view(), ray, kRayId);
    const Hit b = intersect(shut.view(), ray, kRayId);
    ASSERT_EQ(a.instance, b.instance);
    ASSERT_EQ(a.primitive, b.primitive);
    ASSERT_EQ(a.t, b.t);
    ASSERT_EQ(a.u, b.u);
  }
}

/// Number of rays of 4000 whose hits differ between the structures.
int differences(const AccelView& bvh, const AccelView& embree, const TimedSoup& timed, uint32_t seed) {
  Random random(seed);
  int count = 0;
  for (int i = 0; i < 4000; ++i) {
    const float time = random.uniform();
    const Vec3 origin = random.point(-kExtent, kExtent);
    const std::vector<Vec3> corners = i % 100 == 0 ? corners_of(timed.posed_at(time)) : std::vector<Vec3>();
    const Vec3 target = corners.empty() ? random.point(-3, 3) : corners[random.bits() % corners.size()] * 0.99f;
    if (target == origin) continue;
    const Ray ray{origin, glm::normalize(target - origin), kInfinity, time};
    const Hit a = intersect(bvh, ray, kRayId);
    const Hit b = intersect(embree, ray, kRayId);
    const bool same = a.instance == b.instance && a.primitive == b.primitive;
    if (!same) {
      ++count;
      continue;
    }
    EXPECT_EQ(a.t, b.t);  // recomputed from the same corners
    if (a.valid()) {
      EXPECT_EQ(occluded(bvh, ray, kRayId), occluded(embree, ray, kRayId));
    }
  }
  return count;
}

TEST(TimedInstances, EmbreeFindsTheSameHits) {
  const TimedSoup timed(6);
  BvhAccel bvh(timed.soup.meshes, timed.soup.instances, timed.soup.opacity);
  EmbreeAccel embree(timed.soup.meshes, timed.soup.instances, timed.soup.opacity);
  open_shutter(bvh, timed);
  open_shutter(embree, timed);
  EXPECT_LE(differences(bvh.view(), embree.view(), timed, 7), 8);  // at edges
}

TEST(TimedInstances, AClosedShutterLeavesNothingBehind) {
  const TimedSoup timed(8);
  const Soup rest = closed(timed);
  EmbreeAccel embree(timed.soup.meshes, timed.soup.instances, timed.soup.opacity);
  BvhAccel bvh(timed.soup.meshes, timed.soup.instances, timed.soup.opacity);
  const EmbreeAccel embree_at_rest(rest.meshes, rest.instances, rest.opacity);
  const BvhAccel bvh_at_rest(rest.meshes, rest.instances, rest.opacity);
  std::vector<AccelInstance> without_keys = timed.soup.instances;
  for (AccelInstance& instance : without_keys) instance.key_count = 0;
  const uint32_t deforming = 1;
  const auto close = [&](AccelStructure& accel) {
    accel.set_keys({});
    accel.update(without_keys, {&deforming, 1});
  };
  open_shutter(embree, timed);
  open_shutter(bvh, timed);
  close(embree);
  close(bvh);
  Random random(9);
  int differing = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 origin = random.point(-kExtent, kExtent);
    const Ray ray{origin, random.direction(), kInfinity, random.uniform()};
    ASSERT_EQ(intersect(bvh.view(), ray, kRayId).primitive, intersect(bvh_at_rest.view(), ray, kRayId).primitive);
    const Hit a = intersect(embree.view(), ray, kRayId);
    const Hit b = intersect(embree_at_rest.view(), ray, kRayId);
    if (a.instance != b.instance || a.primitive != b.primitive) ++differing;
  }
  EXPECT_LE(differing, 4);  // at edges: the trees differ
}

}  // namespace
}  // namespace relume
