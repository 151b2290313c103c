#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <utility>

#include "scene/testing/figure.h"
#include "viewer/model/document.h"
#include "viewer/testing/render_stage.h"

namespace relume::viewer {
namespace {

using testing::Stage;

constexpr Index kBody = 0;   // node of figure() with the mesh
constexpr Index kJoint = 1;  // the root of the joints

/// Puts a node above the root joint. Returns its index.
Index add_armature(Scene& scene) {
  Node armature;
  armature.name = "armature";
  const Index index = scene.add_node(armature);
  scene.nodes[kJoint].parent = index;
  return index;
}

Scene still_figure() {
  Scene scene = relume::testing::figure();
  scene.animation.clear();
  return scene;
}

Document document_of(Scene scene) {
  return Document(std::make_shared<const LoadedScene>(LoadedScene{"figure", std::move(scene)}));
}

void expect_near(const Vec3& a, const Vec3& b) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-4f) << i;
}

TEST(Figures, TheRootJointMovesASkin) {
  Document document = document_of(still_figure());
  EXPECT_EQ(document.mover(kBody).node, kJoint);
  EXPECT_EQ(document.mover(kBody + 2).node, kBody + 2) << "a joint moves itself";
  const Vec3 before = document.bounds(kBody).center();
  document.move(kBody, {5, 0, 0});
  expect_near(document.bounds(kBody).center(), before);
  document.move(kJoint, {5, 0, 0});
  expect_near(document.bounds(kBody).center(), before + Vec3(5, 0, 0));
}

TEST(Figures, AnAnimatedRootKeepsItsAnimation) {
  Scene scene = relume::testing::figure();
  const Index armature = add_armature(scene);
  const size_t channels = scene.animation.size();
  Document document = document_of(std::move(scene));
  ASSERT_EQ(document.mover(kBody).node, armature);
  document.set_time(1);
  const Box before = document.bounds(kBody);
  document.move(armature, {0, 0, 3});
  expect_near(document.bounds(kBody).low, before.low + Vec3(0, 0, 3));
  expect_near(document.bounds(kBody).high, before.high + Vec3(0, 0, 3));
  EXPECT_EQ(document.outline().animation.size(), channels);
  EXPECT_EQ(document.mover(kBody).node, armature) << "the edit changes nothing";
}

TEST(Figures, InactiveClipsAreConsidered) {
  Scene scene = relume::testing::figure();
  const Index armature = add_armature(scene);
  scene.clips.emplace_back("stretch");
  scene.animation.push_back({3, AnimatedProperty::scale, Interpolation::linear, {0, 1}, {Vec4(1), Vec4(3)}, 0, 1});
  Document document = document_of(std::move(scene));
  document.play("stretch");  // does not move the root joint
  EXPECT_EQ(document.mover(kBody).node, armature);
}

TEST(Figures, ErrorsExplainWhyAFigureCannotMove) {
  const Mover animated = document_of(relume::testing::figure()).mover(kBody);
  EXPECT_EQ(animated.node, kNone);
  EXPECT_NE(animated.problem.find("'joint 0' is animated"), std::string::npos) << animated.problem;
  Scene scene = still_figure();
  scene.nodes[kJoint + 2].parent = kNone;
  const Mover apart = document_of(std::move(scene)).mover(kBody);
  EXPECT_EQ(apart.node, kNone);
  EXPECT_NE(apart.problem.find("no common ancestor"), std::string::npos) << apart.problem;
}

/// Puts the animated figure and a node like `part` below a root. Returns the problem of moving the figure.
std::string problem_beside(const Node& part, Scene scene = relume::testing::figure()) {
  Node root;
  root.name = "root";
  scene.nodes.push_back(part);
  scene.nodes.back().name = "part";
  const Index index = scene.add_node(root);
  for (Index i = 0; i < index; ++i) {
    Node& node = scene.nodes[static_cast<size_t>(i)];
    if (node.parent == kNone) node.parent = index;
  }
  scene.cameras.emplace_back();
  scene.lights.emplace_back();
  Mesh rigid = scene.meshes[0];
  rigid.influences_per_vertex = 0;
  rigid.influences.clear();
  scene.meshes.push_back(rigid);
  const Mover mover = document_of(std::move(scene)).mover(kBody);
  EXPECT_EQ(mover.node, mover.problem.empty() ? index : kNone);
  return mover.problem;
}

TEST(Figures, RejectsNodesThatMoveOtherObjects) {
  EXPECT_EQ(problem_beside({}), "");
  Node room;
  room.meshes = {1};
  Node lamp;
  lamp.light = 0;
  Node camera;
  camera.camera = 0;
  for (Node part : {room, lamp, camera}) {
    const std::string problem = problem_beside(part);
    EXPECT_NE(problem.find("'root', would also move 'part'"), std::string::npos) << problem;
    part.parent = kJoint + 2;
    EXPECT_EQ(problem_beside(part), "") << "it moves with a joint";
  }
}

TEST(Figures, SkinsOfOneSkeletonMoveTogether) {
  Scene scene = relume::testing::figure();
  Node part;
  part.meshes = {0};
  part.skin = 1;
  scene.skins.push_back(scene.skins[0]);
  std::vector<Index>& joints = scene.skins[1].joints;
  joints.assign(joints.size(), kJoint + 2);
  EXPECT_EQ(problem_beside(part, scene), "");
  joints.assign(joints.size(), scene.add_node({}));
  EXPECT_NE(problem_beside(part, scene).find("would also move 'part'"), std::string::npos) << "another figure";
}

TEST(Figures, NodesCarryTheMeshesOfTheirJoints) {
  Scene scene = still_figure();
  const Index armature = add_armature(scene);
  Node shelf;
  shelf.name = "shelf";
  scene.nodes[kBody].parent = scene.add_node(shelf);
  Document document = document_of(std::move(scene));
  EXPECT_FALSE(document.bounds(armature).empty());
  EXPECT_EQ(document.boxes(armature, 64).size(), 1u);
  EXPECT_TRUE(document.bounds(armature + 1).empty()) << "a skin ignores the node above its mesh";
  EXPECT_TRUE(document.make_movable(armature));
  EXPECT_FALSE(document.make_movable(armature + 1));
}

TEST(Figures, TheImageShowsAFigureWhereItWasMoved) {
  Scene scene = still_figure();
  scene.environment.kind = EnvironmentKind::constant;
  const Index armature = add_armature(scene);
  Stage stage("figure", std::move(scene));
  const auto hits_middle = [&] {
    stage.post();
    EXPECT_TRUE(stage.next());
    std::promise<bool> hit;
    stage.thread.post_task([&](const Session& session, const LoadedScene&) {
      hit.set_value(pick(session, {0.5f, 0.5f}).hit);
    });
    return hit.get_future().get();
  };
  ASSERT_TRUE(stage.document.make_movable(armature));
  EXPECT_TRUE(hits_middle());
  stage.document.move(armature, {10, 0, 0});
  EXPECT_FALSE(hits_middle());
}

}  // namespace
}  // namespace relume::viewer
