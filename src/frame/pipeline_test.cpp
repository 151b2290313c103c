#include "frame/pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>

namespace relume {
namespace {

constexpr BufferKey<Vec3> kNormal{"normal"};
constexpr BufferKey<float> kDepth{"depth"};
constexpr BufferKey<float> kOther{"other"};

/// A pass that logs its runs and optionally stops the frame.
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
    return declaration_.name == "long epoch" ? 64 : declaration_.name == "short epoch" ? 8 : 0;
  }
  void abandon() override { *log_ += "-" + std::string(declaration_.name) + " "; }
  bool commits() const override { return declaration_.name == "commits"; }
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
    return pipeline_.run(FrameContext(scene, buffers, backend, {}));
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
  EXPECT_EQ(log_, "trace -trace ");
}

TEST_F(PipelineTest, UndoesAbandonedFramesInReverseOrder) {
  add({.name = "prepare", .stage = Stage::prepare});
  add({.name = "trace", .stage = Stage::trace}, false);
  EXPECT_FALSE(run());
  EXPECT_EQ(log_, "prepare trace -trace -prepare ");
}

TEST_F(PipelineTest, UndoesFramesEndedByExceptions) {
  struct Fail final : Pass {
    PassDeclaration declaration() const override { return {.name = "fail", .stage = Stage::trace}; }
    bool run(const FrameContext&) override { throw std::runtime_error("no memory"); }
  };
  add({.name = "prepare", .stage = Stage::prepare});
  pipeline_.add(std::make_unique<Fail>());
  add({.name = "present", .stage = Stage::present});
  EXPECT_THROW(run(), std::runtime_error);
  EXPECT_EQ(log_, "prepare -prepare ");
}

TEST_F(PipelineTest, UndoesAllPassesAndReportsTheFirstError) {
  struct Fail final : Pass {
    explicit Fail(bool completes) : runs(completes) {}
    PassDeclaration declaration() const override { return {.name = "fail", .stage = Stage::trace}; }
    bool run(const FrameContext&) override {
      if (!runs) throw std::runtime_error("the device is lost");
      return true;
    }
    void abandon() override { throw std::runtime_error("cannot undo"); }
    bool runs;
  };
  const auto message = [&] {
    try {
      run();
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  add({.name = "prepare", .stage = Stage::prepare});
  pipeline_.add(std::make_unique<Fail>(true));
  add({.name = "stopped", .stage = Stage::present}, false);
  EXPECT_EQ(message(), "cannot undo");
  EXPECT_EQ(log_, "prepare stopped -stopped -prepare ");
  log_.clear();
  pipeline_.add(std::make_unique<Fail>(false));
  EXPECT_EQ(message(), "the device is lost");
  EXPECT_EQ(log_, "prepare -prepare ");
}

TEST_F(PipelineTest, CannotStopOnceAPassHasCommitted) {
  std::stop_source stop;
  add({.name = "commits", .stage = Stage::resolve});
  add({.name = "present", .stage = Stage::present});
  const auto stop_at = [&](const char* pass) {
    log_.clear();
    SceneView scene;
    BufferTable buffers(2, 2);
    Backend backend(1);
    return pipeline_.run(FrameContext(scene, buffers, backend, {.stop = stop.get_token()}),
                         [&](const std::string& name) {
                           if (name == pass) stop.request_stop();
                         });
  };
  EXPECT_TRUE(stop_at("commits"));
  EXPECT_EQ(log_, "commits present ");
  EXPECT_FALSE(stop_at("nowhere")) << "the stop was requested before";
  EXPECT_EQ(log_, "-commits ");
}

TEST_F(PipelineTest, StopsLateIfAPassAfterTheImageCan) {
  add({.name = "trace"});
  add({.name = "present", .stage = Stage::present});
  EXPECT_FALSE(pipeline_.stops_late());
  add({.name = "filter", .stage = Stage::denoise});
  EXPECT_TRUE(pipeline_.stops_late());
}

TEST_F(PipelineTest, AcceptsReadsOfEarlierWrites) {
  add({.name = "trace", .stage = Stage::trace, .owns = {{.id = kRadiance}}});
  add({.name = "filter", .stage = Stage::resolve, .reads = {kRadiance}, .writes = {kRadiance}});
  EXPECT_NO_THROW(pipeline_.check());
}

TEST_F(PipelineTest, AcceptsReadingThePreviousFrame) {
  add({.name = "history", .stage = Stage::history, .reads = {kMean, kNormal}});
  add({.name = "accumulate",
       .stage = Stage::present,
       .owns = {{.id = kMean, .persistent = true}, {.id = kNormal, .double_buffered = true}}});
  EXPECT_NO_THROW(pipeline_.check());
}

TEST_F(PipelineTest, RejectsReadsOfLaterWrites) {
  add({.name = "filter", .stage = Stage::resolve, .reads = {kRadiance}});
  add({.name = "late", .stage = Stage::present, .owns = {{.id = kRadiance}}});
  EXPECT_THROW(pipeline_.check(), std::logic_error);
}

TEST_F(PipelineTest, RejectsBuffersWithoutASingleOwner) {
  add({.name = "a", .stage = Stage::trace, .owns = {{.id = kRadiance}}});
  EXPECT_NO_THROW(pipeline_.check());
  add({.name = "b", .stage = Stage::trace, .writes = {kOther}});
  EXPECT_THROW(pipeline_.check(), std::logic_error);
  Pipeline twice;
  for (const char* name : {"a", "b"})
    twice.add(std::make_unique<Probe>(PassDeclaration{.name = name, .owns = {{.id = kRadiance}}}, &log_));
  EXPECT_THROW(twice.check(), std::logic_error);
}

TEST_F(PipelineTest, RejectsBuffersOfAnotherType) {
  constexpr BufferKey<uint32_t> kRadianceAsIntegers{"radiance"};
  for (const bool write : {false, true}) {
    Pipeline pipeline;
    PassDeclaration declaration{.name = "filter", .stage = Stage::resolve};
    (write ? declaration.writes : declaration.reads) = {kRadianceAsIntegers};
    pipeline.add(std::make_unique<Probe>(PassDeclaration{.name = "trace", .owns = {{.id = kRadiance}}}, &log_));
    EXPECT_NO_THROW(pipeline.check());
    pipeline.add(std::make_unique<Probe>(std::move(declaration), &log_));
    EXPECT_THROW(pipeline.check(), std::logic_error);
  }
}

TEST_F(PipelineTest, AcceptsOptionalBuffers) {
  add({.name = "trace", .stage = Stage::trace, .reads_if_any = {kAllocation}});
  add({.name = "accumulate", .stage = Stage::present, .writes_if_any = {kMoments.m2_rgb}});
  EXPECT_NO_THROW(pipeline_.check());
  add({.name = "late", .stage = Stage::present, .owns = {{.id = kAllocation}}});
  EXPECT_THROW(pipeline_.check(), std::logic_error);  // it exists, but is written too late
}

/// A pass that reads or writes a buffer.
class Reach final : public Pass {
 public:
  Reach(PassDeclaration declaration, bool write) : declaration_(std::move(declaration)), write_(write) {}
  PassDeclaration declaration() const override { return declaration_; }
  bool run(const FrameContext& frame) override {
    return write_ ? !frame.write(kRadiance).empty() : !frame.read(kRadiance).empty();
  }

 private:
  PassDeclaration declaration_;
  bool write_;
};

TEST(Pipeline, PassesAccessOnlyDeclaredBuffers) {
  const auto run = [](PassDeclaration declaration, bool write) {
    Pipeline pipeline;
    pipeline.add(std::make_unique<Reach>(std::move(declaration), write));
    SceneView scene;
    BufferTable buffers(2, 2);
    buffers.add({.id = kRadiance});
    Backend backend(1);
    return pipeline.run(FrameContext(scene, buffers, backend, {}));
  };
  for (const bool write : {false, true}) {
    EXPECT_THROW(run({.name = "nothing"}, write), std::logic_error);
    EXPECT_TRUE(run({.name = "owner", .owns = {{.id = kRadiance}}}, write));
    EXPECT_TRUE(run({.name = "writer", .writes = {kRadiance}}, write));
    EXPECT_TRUE(run({.name = "writer", .writes_if_any = {kRadiance}}, write));
  }
  EXPECT_TRUE(run({.name = "reader", .reads = {kRadiance}}, false));
  EXPECT_TRUE(run({.name = "reader", .reads_if_any = {kRadiance}}, false));
  EXPECT_THROW(run({.name = "reader", .reads = {kRadiance}}, true), std::logic_error);
}

TEST(Pipeline, SurfaceBuffersRequireADeclaration) {
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
    buffers.add({.id = kMean, .follows_surface = true});
    buffers.add({.id = kDepth});
    Backend backend(1);
    return pipeline.run(FrameContext(scene, buffers, backend, {}));
  };
  EXPECT_TRUE(run(true));
  EXPECT_THROW(run(false), std::logic_error);
}

TEST_F(PipelineTest, LearnsIfOnePassDoes) {
  add({.name = "trace"});
  EXPECT_EQ(pipeline_.longest_epoch(), 0u);
  add({.name = "long epoch"});
  EXPECT_EQ(pipeline_.longest_epoch(), 64u);
  add({.name = "short epoch"});
  EXPECT_EQ(pipeline_.longest_epoch(), 8u);
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

TEST(BufferTable, SwapsAndClearsChosenBuffers) {
  constexpr BufferKey<float> kTwice{"twice"};
  constexpr BufferKey<float> kSum{"sum"};
  constexpr BufferKey<float> kKept{"kept"};
  BufferTable table(2, 1);
  table.add({.id = kTwice, .double_buffered = true});
  table.add({.id = kSum, .reset = Change::camera | Change::settings});
  table.add({.id = kKept});
  for (const auto& b : table.all()) b->view<float>()[1] = 3.0f;
  table.swap();
  EXPECT_EQ(table.previous(kTwice)[1], 3.0f);
  EXPECT_EQ(table.view(kTwice)[1], 0.0f);
  EXPECT_EQ(table.memory_bytes(), 4u * 2 * sizeof(float));
  table.reset(Change::lights);
  EXPECT_EQ(table.view(kSum)[1], 3.0f);
  table.reset(Change::camera);
  EXPECT_EQ(table.view(kSum)[1], 0.0f);
  EXPECT_EQ(table.view(kKept)[1], 3.0f);
  EXPECT_TRUE(table.view(kOther).empty());
  EXPECT_TRUE(table.previous(kKept).empty());
}

TEST(BufferTable, StartsZeroed) {
  BufferTable table(64, 64);
  table.add({.id = kDepth, .double_buffered = true});
  table.add({.id = kOther, .persistent = true});
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(table.clear_new(stop.get_token()));
  table.keep();
  table.restore();
  const auto is_zero = [](View<const float> values) {
    return std::all_of(values.begin(), values.end(), [](float x) { return x == 0.0f; });
  };
  EXPECT_TRUE(is_zero(table.view(kOther)));
  table.swap();
  EXPECT_TRUE(is_zero(table.view(kDepth)) && is_zero(table.previous(kDepth)));
  table.mutable_view(kDepth)[0] = 1;
  EXPECT_TRUE(table.clear_new({}));
  EXPECT_EQ(table.view(kDepth)[0], 1) << "it is not new any more";
}

TEST(BufferTable, RestoresBuffersChangedInPlace) {
  BufferTable table(2, 1);
  table.add({.id = kDepth, .persistent = true});
  table.add({.id = kOther});
  const auto write = [&](float value) {
    for (const BufferKey<float>& key : {kDepth, kOther}) table.mutable_view(key)[1] = value;
  };
  write(3);
  table.keep();
  EXPECT_EQ(table.memory_bytes(), 3u * 2 * sizeof(float));
  write(5);
  table.restore();
  EXPECT_EQ(table.view(kDepth)[1], 3.0f);
  EXPECT_EQ(table.view(kOther)[1], 5.0f);
}

TEST(BufferTable, RefusesViewsOfAnotherType) {
  BufferTable table(2, 1);
  table.add({.id = kMean});
  EXPECT_THROW(table.view(BufferKey<uint32_t>{kMean.name}), std::logic_error);
  EXPECT_THROW(table.mutable_view(BufferKey<uint64_t>{kMean.name}), std::logic_error);
}

}  // namespace
}  // namespace relume
