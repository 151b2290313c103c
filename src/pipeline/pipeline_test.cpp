#include "pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>
#include <string>

namespace relume {
namespace {

/// A pass that notes its runs and, if asked to, stops the frame.
class Probe final : public Pass {
 public:
  Probe(PassDeclaration declaration, std::string* log, bool goes_on = true)
      : declaration_(std::move(declaration)), log_(log), goes_on_(goes_on) {}

  PassDeclaration declaration() const override { return declaration_; }
  bool run(const FrameContext&) override {
    *log_ += std::string(declaration_.name) + " ";
    return goes_on_;
  }
  uint32_t longest_epoch() const override {
    return declaration_.name == "learns" ? 64 : declaration_.name == "forgets" ? 8 : 0;
  }
  bool keeps_state() const override { return declaration_.name == "keeps"; }
  bool keeps_to_pixels() const override { return declaration_.name != "shares"; }
  bool prepared() const override { return declaration_.name != "unprepared"; }
  size_t memory_bytes() const override { return 10; }
  void save(std::ostream& out) const override { out << declaration_.name.size() << ' '; }
  void load(std::istream& in) override { in >> loaded; }

  size_t loaded = 0;

 private:
  PassDeclaration declaration_;
  std::string* log_;
  bool goes_on_;
};

class PipelineTest : public ::testing::Test {
 protected:
  void add(PassDeclaration declaration, bool goes_on = true) {
    pipeline_.add(std::make_unique<Probe>(std::move(declaration), &log_, goes_on));
  }
  bool run() {
    SceneView scene;
    BufferTable buffers(2, 2);
    Backend backend(1);
    return pipeline_.run(FrameContext{scene, buffers, backend, {}, 0, 0, Change::none, {}});
  }

  Pipeline pipeline_;
  std::string log_;
};

TEST_F(PipelineTest, RunsByStageAndKeepsTheOrderWithin) {
  add({.name = "present", .stage = Stage::present});
  add({.name = "trace", .stage = Stage::trace});
  add({.name = "first", .stage = Stage::prepare});
  add({.name = "second", .stage = Stage::prepare});
  EXPECT_TRUE(run());
  EXPECT_EQ(log_, "first second trace present ");
}

TEST_F(PipelineTest, EndsTheFrameWhereAPassWasStopped) {
  add({.name = "trace", .stage = Stage::trace}, false);
  add({.name = "present", .stage = Stage::present});
  EXPECT_FALSE(run());
  EXPECT_EQ(log_, "trace ");
}

TEST_F(PipelineTest, AcceptsPassesThatReadWhatEarlierOnesWrite) {
  add({.name = "trace", .stage = Stage::trace, .owns = {{.name = "radiance"}}});
  add({.name = "filter", .stage = Stage::resolve, .reads = {"radiance"}, .writes = {"radiance"}});
  EXPECT_NO_THROW(pipeline_.check());
}

TEST_F(PipelineTest, AcceptsReadingTheFrameBefore) {
  add({.name = "history", .stage = Stage::history, .reads = {"mean", "normal"}});
  add({.name = "accumulate",
       .stage = Stage::present,
       .owns = {{.name = "mean", .persistent = true}, {.name = "normal", .double_buffered = true}}});
  EXPECT_NO_THROW(pipeline_.check());
}

TEST_F(PipelineTest, RefusesReadingWhatIsWrittenLater) {
  add({.name = "filter", .stage = Stage::resolve, .reads = {"radiance"}});
  add({.name = "late", .stage = Stage::present, .owns = {{.name = "radiance"}}});
  EXPECT_THROW(pipeline_.check(), std::logic_error);
}

TEST_F(PipelineTest, RefusesBuffersWithoutOwnerOrWithTwo) {
  add({.name = "a", .stage = Stage::trace, .owns = {{.name = "radiance"}}});
  EXPECT_NO_THROW(pipeline_.check());
  add({.name = "b", .stage = Stage::trace, .writes = {"nothing"}});
  EXPECT_THROW(pipeline_.check(), std::logic_error);
  Pipeline twice;
  for (const char* name : {"a", "b"})
    twice.add(std::make_unique<Probe>(PassDeclaration{.name = name, .owns = {{.name = "radiance"}}}, &log_));
  EXPECT_THROW(twice.check(), std::logic_error);
}

TEST_F(PipelineTest, AcceptsWhatIsReadOrWrittenOnlyWhereItExists) {
  add({.name = "trace", .stage = Stage::trace, .reads_if_any = {"allocation"}});
  add({.name = "accumulate", .stage = Stage::present, .writes_if_any = {"adaptive-m2"}});
  EXPECT_NO_THROW(pipeline_.check());
  add({.name = "late", .stage = Stage::present, .owns = {{.name = "allocation"}}});
  EXPECT_THROW(pipeline_.check(), std::logic_error);  // it exists, and is written too late
}

/// A pass that looks at a buffer, to read or to write it.
class Reach final : public Pass {
 public:
  Reach(PassDeclaration declaration, bool write) : declaration_(std::move(declaration)), write_(write) {}
  PassDeclaration declaration() const override { return declaration_; }
  bool run(const FrameContext& frame) override {
    return write_ ? !frame.view<float>("radiance").empty() : !frame.view<const float>("radiance").empty();
  }

 private:
  PassDeclaration declaration_;
  bool write_;
};

TEST(Pipeline, PassesSeeOnlyWhatTheyDeclare) {
  const auto run = [](PassDeclaration declaration, bool write) {
    Pipeline pipeline;
    pipeline.add(std::make_unique<Reach>(std::move(declaration), write));
    SceneView scene;
    BufferTable buffers(2, 2);
    buffers.add({.name = "radiance"});
    Backend backend(1);
    return pipeline.run(FrameContext{scene, buffers, backend, {}, 0, 0, Change::none, {}});
  };
  for (const bool write : {false, true}) {
    EXPECT_THROW(run({.name = "nothing"}, write), std::logic_error);
    EXPECT_TRUE(run({.name = "owner", .owns = {{.name = "radiance"}}}, write));
    EXPECT_TRUE(run({.name = "writer", .writes = {"radiance"}}, write));
    EXPECT_TRUE(run({.name = "writer", .writes_if_any = {"radiance"}}, write));
  }
  EXPECT_TRUE(run({.name = "reader", .reads = {"radiance"}}, false));
  EXPECT_TRUE(run({.name = "reader", .reads_if_any = {"radiance"}}, false));
  EXPECT_THROW(run({.name = "reader", .reads = {"radiance"}}, true), std::logic_error);
}

TEST(Pipeline, OnlyPassesThatDeclareItMoveWhatFollowsTheSurface) {
  struct Move final : Pass {
    explicit Move(bool declares) : moves(declares) {}
    PassDeclaration declaration() const override { return {.name = "move", .moves_surfaces = moves}; }
    bool run(const FrameContext& frame) override {
      int count = 0;
      frame.for_each_surface_buffer([&](const Buffer&) { ++count; });
      return count == 1;
    }
    bool moves;
  };
  const auto run = [](bool declares) {
    Pipeline pipeline;
    pipeline.add(std::make_unique<Move>(declares));
    SceneView scene;
    BufferTable buffers(2, 2);
    buffers.add({.name = "mean", .follows_surface = true});
    buffers.add({.name = "depth"});
    Backend backend(1);
    return pipeline.run(FrameContext{scene, buffers, backend, {}, 0, 0, Change::none, {}});
  };
  EXPECT_TRUE(run(true));
  EXPECT_THROW(run(false), std::logic_error);
}

TEST_F(PipelineTest, LearnsAndKeepsStateIfOnePassDoes) {
  add({.name = "trace"});
  EXPECT_EQ(pipeline_.longest_epoch(), 0u);
  add({.name = "learns"});
  EXPECT_EQ(pipeline_.longest_epoch(), 64u);
  add({.name = "forgets"});
  EXPECT_EQ(pipeline_.longest_epoch(), 8u);
  EXPECT_FALSE(pipeline_.keeps_state());
  add({.name = "keeps"});
  EXPECT_TRUE(pipeline_.keeps_state());
  EXPECT_TRUE(pipeline_.keeps_to_pixels());
  add({.name = "shares"});
  EXPECT_FALSE(pipeline_.keeps_to_pixels());
  EXPECT_TRUE(pipeline_.prepared());
  add({.name = "unprepared"});
  EXPECT_FALSE(pipeline_.prepared());
}

TEST_F(PipelineTest, SavesAndLoadsPassByPass) {
  auto first = std::make_unique<Probe>(PassDeclaration{.name = "one"}, &log_);
  auto second = std::make_unique<Probe>(PassDeclaration{.name = "three"}, &log_);
  const Probe& a = *first;
  const Probe& b = *second;
  pipeline_.add(std::move(first));
  pipeline_.add(std::move(second));
  std::stringstream stream;
  pipeline_.save(stream);
  pipeline_.load(stream);
  EXPECT_EQ(a.loaded, 3u);
  EXPECT_EQ(b.loaded, 5u);
  EXPECT_EQ(pipeline_.memory_bytes(), 20u);
}

TEST(BufferTable, SwapsAndClearsWhatItIsToldTo) {
  BufferTable table(2, 1);
  table.add({.name = "twice", .double_buffered = true});
  table.add({.name = "sum", .reset = Change::camera | Change::settings});
  table.add({.name = "kept"});
  for (const auto& b : table.all()) b->view<float>()[1] = 3.0f;
  table.swap();
  EXPECT_EQ(table.previous<float>("twice")[1], 3.0f);
  EXPECT_EQ(table.view<float>("twice")[1], 0.0f);
  EXPECT_EQ(table.memory_bytes(), 4u * 2 * sizeof(float));
  table.reset(Change::lights);
  EXPECT_EQ(table.view<float>("sum")[1], 3.0f);
  table.reset(Change::camera);
  EXPECT_EQ(table.view<float>("sum")[1], 0.0f);
  EXPECT_EQ(table.view<float>("kept")[1], 3.0f);
  EXPECT_TRUE(table.view<float>("absent").empty());
  EXPECT_TRUE(table.previous<float>("kept").empty());
}

}  // namespace
}  // namespace relume
