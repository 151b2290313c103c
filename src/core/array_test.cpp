#include "core/array.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace relume {
namespace {

struct Record {
  int number = 7;
  float weight = 0.5f;
  bool operator==(const Record&) const = default;
};

/// Memory that counts its blocks, and fills new ones with a pattern.
class CountedMemory final : public Memory {
 public:
  void* allocate(size_t bytes, size_t alignment) override {
    void* const block = host_memory().allocate(bytes, alignment);
    std::memset(block, 0xa5, bytes);
    blocks_[block] = bytes;
    ++allocations;
    return block;
  }
  void deallocate(void* block, size_t bytes, size_t alignment) noexcept override {
    EXPECT_EQ(blocks_[block], bytes);
    blocks_.erase(block);
    host_memory().deallocate(block, bytes, alignment);
  }
  void open_for_reading(const void* block) override {
    if (opening_fails) throw std::runtime_error("the device has failed");
    reads += blocks_.count(const_cast<void*>(block));
  }
  void open_for_writing(void* block) override {
    if (opening_fails) throw std::runtime_error("the device has failed");
    writes += blocks_.count(block);
  }

  size_t blocks() const { return blocks_.size(); }
  bool opening_fails = false;
  int allocations = 0;
  size_t reads = 0;
  size_t writes = 0;

 private:
  std::map<void*, size_t> blocks_;
};

template <typename T>
std::vector<T> elements_of(const Array<T>& array) {
  const std::span<const T> elements = array.read();
  return {elements.begin(), elements.end()};
}

/// The flags of the mapping that holds an address, as in /proc/self/smaps.
std::string mapping_flags(const void* address) {
  std::ifstream file("/proc/self/smaps");
  bool holds = false;
  for (std::string line; std::getline(file, line);) {
    uintptr_t first = 0;
    uintptr_t end = 0;
    char dash = 0;
    if (std::istringstream range(line); range >> std::hex >> first >> dash >> end && dash == '-') {
      const auto value = reinterpret_cast<uintptr_t>(address);
      holds = first <= value && value < end;
    }
    if (holds && line.starts_with("VmFlags:")) return line + " ";
  }
  return {};
}

TEST(HostMemory, AsksForHugePagesOfLargeBlocks) {
  if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage")) GTEST_SKIP() << "the system has no huge pages";
  Array<Record> small;
  small.reset(64);
  Array<Record> large;
  large.reset(4u << 20);
  const auto* const start = large.read().data();
  EXPECT_EQ(reinterpret_cast<uintptr_t>(start) % (2u << 20), 0u);
  for (const size_t i : {size_t{0}, large.read().size() - (2u << 20)})
    EXPECT_NE(mapping_flags(start + i).find(" hg "), std::string::npos) << i;
  EXPECT_EQ(mapping_flags(small.read().data()).find(" hg "), std::string::npos);
}

TEST(Array, NewElementsHaveTheirDefaultValue) {
  CountedMemory memory;
  Array<uint32_t> numbers(memory);
  numbers.reset(3);
  EXPECT_EQ(elements_of(numbers), (std::vector<uint32_t>{0, 0, 0}));
  Array<Record> records(memory);
  records.resize(2);
  EXPECT_EQ(elements_of(records), (std::vector<Record>{{}, {}}));
  records.reset(2, kUninitialized);
  EXPECT_EQ(records.size(), 2u);
}

TEST(Array, KeepsItsBlockIfAnotherCannotBeOpened) {
  CountedMemory memory;
  Array<int> array(memory);
  array.assign(std::vector<int>{1, 2, 3});
  memory.opening_fails = true;
  EXPECT_THROW(array.resize(10), std::runtime_error);
  EXPECT_THROW(array.reserve(10), std::runtime_error);
  EXPECT_THROW(array.push_back(4), std::runtime_error);
  memory.opening_fails = false;
  EXPECT_EQ(memory.blocks(), 1u);
  EXPECT_EQ(elements_of(array), (std::vector<int>{1, 2, 3}));
}

TEST(Array, ResizeKeepsTheFirstElements) {
  Array<int> array;
  array.assign(std::vector<int>{1, 2, 3});
  array.resize(5);
  EXPECT_EQ(elements_of(array), (std::vector<int>{1, 2, 3, 0, 0}));
  array.resize(2);
  array.resize(3);
  EXPECT_EQ(elements_of(array), (std::vector<int>{1, 2, 0}));
  array.push_back(4);
  array.append(std::vector<int>{5, 6});
  array.append({});
  EXPECT_EQ(elements_of(array), (std::vector<int>{1, 2, 0, 4, 5, 6}));
  array.shrink_to_fit();
  EXPECT_EQ(array.memory_bytes(), 6 * sizeof(int));
  EXPECT_EQ(elements_of(array), (std::vector<int>{1, 2, 0, 4, 5, 6}));
  array.clear();
  array.shrink_to_fit();
  EXPECT_EQ(array.memory_bytes(), 0u);
}

TEST(Array, AllocatesOnlyToGrow) {
  CountedMemory memory;
  Array<int> array(memory);
  array.reset(0);
  EXPECT_EQ(memory.allocations, 0);
  for (int i = 0; i < 4; ++i) {
    array.reset(100);
    array.assign(100, 3);
    array.resize(90);
    array.clear();
  }
  EXPECT_EQ(memory.allocations, 1);
  for (int i = 0; i < 1000; ++i) array.push_back(i);
  EXPECT_LT(memory.allocations, 12);
  EXPECT_EQ(memory.blocks(), 1u);
  const int before = memory.allocations;
  array.reserve(5000);
  for (int i = 0; i < 1000; ++i) array.push_back(array.read()[0]);
  EXPECT_EQ(memory.allocations, before + 1);
}

TEST(Array, CopiesKeepTheirMemoryAndMovesTransferIt) {
  CountedMemory a;
  CountedMemory b;
  Array<int> first(a);
  first.assign(4, 9);
  Array<int> second(b);
  second = first;
  EXPECT_EQ(&second.memory(), &b);
  EXPECT_EQ(elements_of(second), elements_of(first));
  second = std::move(first);
  EXPECT_EQ(&second.memory(), &a);
  EXPECT_TRUE(first.empty());  // NOLINT(bugprone-use-after-move): documented
  EXPECT_EQ(b.blocks(), 0u);
  Array<int> third(second);
  third.swap(second);
  EXPECT_EQ(elements_of(third), std::vector<int>(4, 9));
}

TEST(Array, ReportsHostAccessToItsMemory) {
  CountedMemory memory;
  Array<int> array(memory);
  EXPECT_TRUE(array.read().empty());
  EXPECT_TRUE(array.write().empty());
  array.reset(3, kUninitialized);
  EXPECT_EQ(array.view().size + array.mutable_view().size, 6u);
  EXPECT_EQ(memory.reads + memory.writes, 0u);
  array.read();
  EXPECT_EQ(memory.reads, 1u);
  array.write()[1] = 4;
  EXPECT_EQ(memory.writes, 1u);
  EXPECT_EQ(array.view()[1], 4);
  array.permit_reading();
  EXPECT_EQ(memory.reads, 2u);
  Array<int>(memory).permit_reading();
  EXPECT_EQ(memory.reads, 2u) << "it has no block";
}

TEST(Memory, CopiesAndClearsAfterOpeningTheBlocks) {
  CountedMemory memory;
  Array<int> from(memory);
  Array<int> to(memory);
  from.assign(std::vector<int>{1, 2, 3});
  to.assign(std::vector<int>{4, 5, 6});
  const size_t reads = memory.reads;
  const size_t writes = memory.writes;
  memory.copy(to.mutable_view().data, from.view().data, 2 * sizeof(int));
  EXPECT_EQ(memory.reads, reads + 1);
  EXPECT_EQ(memory.writes, writes + 1);
  memory.zero(from.mutable_view().data, 3 * sizeof(int));
  EXPECT_EQ(memory.writes, writes + 2);
  EXPECT_EQ(elements_of(to), (std::vector<int>{1, 2, 6}));
  EXPECT_EQ(elements_of(from), (std::vector<int>{0, 0, 0}));
}

TEST(Array, RejectsMoreElementsThanAViewCanCount) {
  Array<uint8_t> array;
  const auto problem = [&](const auto& grow) -> std::string {
    try {
      grow();
    } catch (const std::length_error& error) {
      return error.what();
    }
    return "";
  };
  const size_t count = size_t{1} << 32;
  EXPECT_NE(problem([&] { array.reset(count); }).find("4294967296 elements"), std::string::npos);
  EXPECT_NE(problem([&] { array.resize(count); }).find("4294967296 elements"), std::string::npos);
  EXPECT_TRUE(array.empty());
}

TEST(Array, RespectsAlignment) {
  struct alignas(64) Line {
    float values[16];
  };
  Array<Line> lines;
  lines.reset(3);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(lines.view().data) % 64, 0u);
}

TEST(KernelValue, HasOneElement) {
  KernelValue<uint64_t> count;
  EXPECT_EQ(count.read(), 0u);
  count.mutable_view()[0] += 5;
  count.write() += 1;
  EXPECT_EQ(count.read(), 6u);
}

}  // namespace
}  // namespace relume
