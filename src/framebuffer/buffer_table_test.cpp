// Buffers copy and clear their content with the functions of their memory, which a device executes itself.
#include "framebuffer/buffer_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace relume {
namespace {

constexpr BufferKey<uint32_t> kCount{"count"};
constexpr BufferKey<uint32_t> kPrevious{"previous"};

/// Host memory that counts accesses of host code, and bytes that it copies and clears itself.
class CountingMemory final : public Memory {
 public:
  void* allocate(size_t bytes, size_t alignment) override { return host_memory().allocate(bytes, alignment); }
  void deallocate(void* block, size_t bytes, size_t alignment) noexcept override {
    host_memory().deallocate(block, bytes, alignment);
  }
  void open_for_reading(const void*) override { ++opened; }
  void open_for_writing(void*) override { ++opened; }
  void copy(void* to, const void* from, size_t bytes) override {
    std::memcpy(to, from, bytes);
    copied += bytes;
  }
  void zero(void* to, size_t bytes) override {
    std::memset(to, 0, bytes);
    cleared += bytes;
  }

  std::atomic<size_t> opened = 0;
  std::atomic<size_t> copied = 0;
  std::atomic<size_t> cleared = 0;
};

class BufferTableTest : public ::testing::Test {
 protected:
  static constexpr size_t kBytes = 40 * 30 * sizeof(uint32_t);

  bool is_filled(uint32_t value) {
    const View<uint32_t> elements = count_.view<uint32_t>();
    return std::all_of(elements.data, elements.data + elements.size, [&](uint32_t e) { return e == value; });
  }
  void fill(uint32_t value) {
    const View<uint32_t> elements = count_.view<uint32_t>();
    std::fill(elements.data, elements.data + elements.size, value);
  }

  CountingMemory memory_;
  BufferTable table_{40, 30, BlockPool::create(memory_)};
  Buffer& count_ = table_.add({.id = kCount, .persistent = true});
};

TEST_F(BufferTableTest, ClearsNewBuffers) {
  EXPECT_TRUE(table_.clear_new({}));
  EXPECT_TRUE(is_filled(0));
  EXPECT_EQ(memory_.cleared, kBytes);
  EXPECT_EQ(memory_.opened, 0u);
}

TEST_F(BufferTableTest, ClearsBothHalves) {
  Buffer& previous = table_.add({.id = kPrevious, .double_buffered = true});
  previous.clear();
  EXPECT_EQ(memory_.cleared, 0u) << "it is still new";
  previous.view<uint32_t>();
  previous.clear();
  EXPECT_EQ(memory_.cleared, 4 * kBytes);
  EXPECT_EQ(memory_.opened, 0u);
}

TEST_F(BufferTableTest, KeepsAndRestoresContent) {
  fill(3);
  table_.keep();
  fill(4);
  table_.restore();
  EXPECT_TRUE(is_filled(3));
  EXPECT_EQ(memory_.copied, 2 * kBytes);
  EXPECT_EQ(memory_.opened, 0u);
}

TEST_F(BufferTableTest, OpensContentForHostCode) {
  EXPECT_EQ(count_.bytes().size(), kBytes);
  EXPECT_EQ(memory_.opened, 1u);
}

}  // namespace
}  // namespace relume
