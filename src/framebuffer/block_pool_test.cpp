#include "framebuffer/block_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include "framebuffer/buffer_table.h"

namespace relume {
namespace {

class BlockPoolTest : public ::testing::Test {
 protected:
  void SetUp() override { pool_->raise_limit(1000); }

  std::shared_ptr<BlockPool> pool_ = BlockPool::create();
};

/// AddressSanitizer builds reuse no blocks, so that it finds accesses to released buffers.
class SpareBlocks : public BlockPoolTest {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "AddressSanitizer builds reuse no blocks";
#endif
    BlockPoolTest::SetUp();
  }
  /// Makes a block of that size spare.
  void release(size_t bytes) const { pool_->take(bytes); }
};

TEST_F(SpareBlocks, AreReusedAtEqualSizeOnly) {
  BlockPool::Block block = pool_->take(600);
  const std::byte* address = block.get();
  block.reset();
  EXPECT_EQ(pool_->spare_bytes(), 600u);
  const BlockPool::Block smaller = pool_->take(599);
  EXPECT_EQ(pool_->spare_bytes(), 600u);
  const BlockPool::Block same = pool_->take(600);
  EXPECT_EQ(same.get(), address);
  EXPECT_EQ(pool_->spare_bytes(), 0u);
}

TEST_F(SpareBlocks, AreFreedAboveTheLimitSmallestFirst) {
  for (int i = 0; i < 10; ++i) {
    release(1000);
    release(10);
    EXPECT_EQ(pool_->spare_bytes(), 1000u);
  }
  release(1001);
  EXPECT_EQ(pool_->spare_bytes(), 1000u) << "larger than the limit";
}

TEST_F(SpareBlocks, AreFreedIfNoSizeHasUsedThem) {
  release(600);
  for (uint32_t i = 0; i < BlockPool::kKeptChanges; ++i) pool_->next_size();
  release(300);
  EXPECT_EQ(pool_->spare_bytes(), 900u);
  pool_->next_size();
  EXPECT_EQ(pool_->spare_bytes(), 300u);
  pool_->clear();
  EXPECT_EQ(pool_->spare_bytes(), 0u);
}

TEST_F(BlockPoolTest, LivesAsLongAsItsBlocks) {
  const std::weak_ptr<BlockPool> watched = pool_;
  {
    const BlockPool::Block block = pool_->take(100);
    pool_.reset();
    EXPECT_FALSE(watched.expired());
  }
  EXPECT_TRUE(watched.expired());
}

TEST_F(BlockPoolTest, GivesEachThreadItsOwnBlock) {
  std::vector<std::jthread> threads;
  for (int thread = 1; thread <= 4; ++thread) {
    threads.emplace_back([this, thread] {
      for (int n = 0; n < 1000; ++n) {
        const BlockPool::Block block = pool_->take(64);
        std::memset(block.get(), thread, 64);
        std::this_thread::yield();
        const std::span<const std::byte> bytes(block.get(), 64);
        const bool own = std::all_of(bytes.begin(), bytes.end(), [&](std::byte b) { return b == std::byte(thread); });
        ASSERT_TRUE(own);
      }
    });
  }
  threads.clear();
  EXPECT_LE(pool_->spare_bytes(), 4u * 64u);
}

TEST_F(SpareBlocks, GiveZeroedBuffers) {
  const BufferKey<uint32_t> key{"counts"};
  const auto table = [&] {
    BufferTable result(4, 4, pool_);
    result.add({.id = key, .double_buffered = true});
    return result;
  };
  {
    BufferTable used = table();
    for (int frame = 0; frame < 2; ++frame) {
      for (uint32_t& count : used.mutable_view(key)) count = 0xffffffff;
      used.swap();
    }
  }
  EXPECT_EQ(pool_->spare_bytes(), 128u);
  const BufferTable fresh = table();
  EXPECT_EQ(pool_->spare_bytes(), 0u);
  for (const uint32_t count : fresh.view(key)) EXPECT_EQ(count, 0u);
  for (const uint32_t count : fresh.previous(key)) EXPECT_EQ(count, 0u);
}

}  // namespace
}  // namespace relume
