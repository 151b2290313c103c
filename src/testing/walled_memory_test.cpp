#include "testing/walled_memory.h"

#include <gtest/gtest.h>

#include <numeric>

#include "frame/launch.h"

namespace relume {
namespace {

struct AddKernel {
  uint8_t step = 1;
  View<const uint32_t> from;
  View<uint32_t> to;

  RELUME_HD void operator()(uint32_t x, uint32_t) const { to[x] = from[x] + step; }
};

class WalledMemoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    backend_.on_launch([this](const LaunchEvent& event) {
      switch (event.kind) {
        case LaunchEvent::Kind::kernel:
          memory_.announce_kernel();
          return memory_.check_kernel(event.name, event.argument);
        case LaunchEvent::Kind::begins: return memory_.begin_launch(event.name);
        case LaunchEvent::Kind::ends: return memory_.end_launch();
      }
    });
    from_.assign(4, 5);
    to_.reset(4);
    memory_.end_launch();
  }
  void add(View<const uint32_t> from) { launch(backend_, "add", AddKernel{1, from, to_.mutable_view()}, 4, 1); }
  static uint32_t sum(std::span<const uint32_t> values) { return std::accumulate(values.begin(), values.end(), 0u); }

  testing::WalledMemory memory_;
  Backend backend_{2, KernelForm::host, memory_};
  Array<uint32_t> from_{memory_};
  Array<uint32_t> to_{memory_};
};

TEST_F(WalledMemoryTest, PermitsLaunchesAndOpenedArrays) {
  add(from_.view());
  EXPECT_EQ(sum(to_.read()), 24u);
  from_.write()[2] = 7;
  from_.resize(1000);
  add(from_.view());
  EXPECT_EQ(sum(to_.read()), 26u);
  const Array<uint32_t> copy = to_;
  EXPECT_EQ(sum(copy.read()), 26u);
  uint32_t inside = 0;
  backend_.run("host", [&] { inside = to_.view()[0]; });
  EXPECT_EQ(inside, 6u);
  EXPECT_TRUE(memory_.violations().empty()) << memory_.violations().front();
}

TEST_F(WalledMemoryTest, RecordsKernelsThatAccessOtherMemory) {
#if !__has_builtin(__builtin_clear_padding)
  GTEST_SKIP() << "the compiler cannot clear padding";
#endif
  const std::vector<uint32_t> other(4, 2);
  add(view_of(other));
  ASSERT_EQ(memory_.violations().size(), 1u);
  EXPECT_NE(memory_.violations()[0].find("kernel 'add' holds an address outside the backend's memory at byte 8 of 40"),
            std::string::npos)
      << memory_.violations()[0];
  memory_.permit(other.data());
  add(view_of(other));
  EXPECT_EQ(memory_.violations().size(), 1u);
}

TEST_F(WalledMemoryTest, RecordsAddressesInArrays) {
  struct Record {
    uint64_t number = 0;
    View<const uint32_t> values;
  };
  Array<Record> records(memory_);
  records.assign(2, Record{});
  const auto check = [&] {
    backend_.run("check", [&] { memory_.check_elements("records", records.view()); });
    return memory_.violations();
  };
  EXPECT_TRUE(check().empty());
  records.write()[1].values = from_.view();
  ASSERT_EQ(check().size(), 1u);
  EXPECT_NE(check()[0].find("the array 'records' holds an address at byte 32 of 48"), std::string::npos) << check()[0];
}

TEST_F(WalledMemoryTest, RecordsHostCodeBetweenLaunches) {
  add(from_.view());
  EXPECT_EQ(sum({to_.view().data, 4}), 24u);
  ASSERT_EQ(memory_.violations().size(), 1u);
  EXPECT_NE(memory_.violations()[0].find("accessed a block of 16 bytes after the launch of 'add'"), std::string::npos)
      << memory_.violations()[0];
  const std::span<const uint32_t> before = to_.read();
  add(from_.view());
  EXPECT_EQ(sum(before), 24u) << "the span ended with the launch";
  EXPECT_EQ(memory_.violations().size(), 2u);
  from_.read();
  from_.mutable_view()[0] = 1;
  ASSERT_EQ(memory_.violations().size(), 3u);
  EXPECT_NE(memory_.violations()[2].find("wrote to"), std::string::npos);
}

TEST_F(WalledMemoryTest, CopiesBetweenClosedBlocks) {
  memory_.limit_host_access(8);
  memory_.copy(to_.mutable_view().data, from_.view().data + 1, 3 * sizeof(uint32_t));
  memory_.zero(to_.mutable_view().data + 1, sizeof(uint32_t));
  EXPECT_TRUE(memory_.violations().empty()) << memory_.violations().front();
  memory_.permit_host_access();
  EXPECT_EQ(sum(to_.read()), 10u);
  EXPECT_EQ(sum(from_.read()), 20u);
  memory_.copy(to_.mutable_view().data, from_.view().data, sizeof(uint32_t));
  EXPECT_EQ(to_.view()[1], 0u) << "closed by the copy";
  ASSERT_EQ(memory_.violations().size(), 1u);
  EXPECT_NE(memory_.violations()[0].find("accessed a block of 16 bytes"), std::string::npos);
}

TEST_F(WalledMemoryTest, PermitsReading) {
  add(from_.view());
  to_.permit_reading();
  EXPECT_EQ(to_.view()[2], 6u);
  EXPECT_TRUE(memory_.violations().empty()) << memory_.violations().front();
  to_.mutable_view()[2] = 1;
  EXPECT_EQ(memory_.violations().size(), 1u);
}

TEST_F(WalledMemoryTest, RecordsLargeBlocksThatHostCodeOpens) {
  memory_.limit_host_access(16);
  from_.assign(5, 5);
  add(from_.view());
  EXPECT_EQ(sum(to_.read()), 24u) << "a small block";
  backend_.run("host", [&] { EXPECT_EQ(sum(from_.read()), 25u); });
  ASSERT_EQ(memory_.violations().size(), 1u) << "assign()";
  EXPECT_EQ(sum(from_.read()), 25u);
  EXPECT_EQ(sum(from_.read()), 25u) << "open already";
  ASSERT_EQ(memory_.violations().size(), 3u);
  EXPECT_EQ(memory_.violations()[1],
            "host code opened a block of 20 bytes after the launch of 'host'; process it in a launch");
  memory_.limit_host_access(16, {20});
  EXPECT_EQ(sum(from_.read()), 25u);
  memory_.permit_host_access();
  add(from_.view());
  EXPECT_EQ(sum(from_.read()), 25u);
  EXPECT_EQ(memory_.violations().size(), 3u);
}

TEST_F(WalledMemoryTest, CountsBlocksThatTimedHostCodeAccesses) {
  const auto bytes_of = [&](const char* name) { return memory_.host_work().at(name); };
  memory_.count_host_work();
  add(from_.view());
  EXPECT_TRUE(memory_.host_work().empty()) << "a kernel";
  backend_.run("host", [&] {
    from_.write()[0] = 1;
    from_.mutable_view()[1] = 2;
    to_.mutable_view()[0] = 3;
    memory_.zero(to_.mutable_view().data, sizeof(uint32_t));
    to_.mutable_view()[1] = 3;
  });
  EXPECT_EQ(bytes_of("host"), 32u) << "each block counts once";
  backend_.run("host", [&] { to_.read(); });
  EXPECT_EQ(bytes_of("host"), 32u) << "the launch with most";
  backend_.run("clear", [&] { memory_.zero(to_.mutable_view().data, sizeof(uint32_t)); });
  EXPECT_FALSE(memory_.host_work().contains("clear"));
  backend_.run("new", [&] { Array<uint32_t>(memory_).assign(3, 1); });
  EXPECT_EQ(bytes_of("new"), 12u);
  backend_.run("nested", [&] {
    from_.write()[0] = 5;
    add(from_.view());
  });
  EXPECT_EQ(bytes_of("nested"), 16u) << "kernels do not count";
  EXPECT_EQ(to_.read()[0], 6u);
  EXPECT_TRUE(memory_.violations().empty()) << memory_.violations().front();
}

TEST_F(WalledMemoryTest, ClosesAfterExceptions) {
  EXPECT_THROW(backend_.run("host", [] { throw std::runtime_error("expected"); }), std::runtime_error);
  EXPECT_EQ(sum({to_.view().data, 4}), 0u);
  EXPECT_EQ(memory_.violations().size(), 1u);
}

}  // namespace
}  // namespace relume
