// Memory that kernels access, and arrays that own it. A view of an array is a kernel's argument; read() and write()
// give the elements to host code, and wait for the device's queued launches.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include "core/view.h"

namespace relume {

/// Source of the memory that kernels access. Thread-safe.
class Memory {
 public:
  virtual ~Memory() = default;

  /// Returns an uninitialised block. `alignment`: a power of two, bytes. Throws std::bad_alloc.
  virtual void* allocate(size_t bytes, size_t alignment) = 0;
  /// Frees a block. `bytes` and `alignment` are those of its allocation.
  virtual void deallocate(void* block, size_t bytes, size_t alignment) noexcept = 0;

  /// Waits for the device's queued launches. Host code may then read the block until the next launch begins.
  virtual void open_for_reading(const void* /*block*/) {}
  /// The same for reading and writing.
  virtual void open_for_writing(void* /*block*/) {}
  /// As open_for_reading(), for host code that reads few elements: a device need not copy the whole block.
  virtual void permit_reading(const void* block) { open_for_reading(block); }

  /// Copies bytes between two blocks, from and to any address in them. The regions must not overlap. A device copies
  /// them in the order of launches, and the host then has no access to the blocks.
  virtual void copy(void* to, const void* from, size_t bytes) {
    open_for_reading(from);
    open_for_writing(to);
    std::memcpy(to, from, bytes);
  }
  /// Sets bytes of a block to zero, from any address in it on. Otherwise as copy().
  virtual void zero(void* to, size_t bytes) {
    open_for_writing(to);
    std::memset(to, 0, bytes);
  }
};

/// The memory of the processor. The host may always access it. Lives as long as the process.
Memory& host_memory();

/// Tag for uninitialised elements. The host or a kernel writes them before the first read.
struct Uninitialized {};
inline constexpr Uninitialized kUninitialized;

namespace detail {
/// Throws std::length_error with the number of elements.
[[noreturn]] void fail_array_size(size_t elements);
}  // namespace detail

/// Owns elements that kernels access.
/// Views are valid until the size changes or the array is destroyed; spans only until the next launch.
/// Throws std::length_error above kMaxSize elements, std::bad_alloc if allocation fails.
template <typename T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>, "kernels access plain data only");

 public:
  /// Limit of the 32-bit element count of views.
  static constexpr size_t kMaxSize = std::numeric_limits<uint32_t>::max();

  /// An empty array, which takes its elements from `memory`. The memory must outlive it.
  explicit Array(Memory& memory = host_memory()) : memory_(&memory) {}
  /// Copies the elements, and takes the copies from the same memory.
  Array(const Array& other) : memory_(other.memory_) { assign(other.read()); }
  /// Copies the elements, and keeps its own memory.
  Array& operator=(const Array& other) {
    if (this != &other) assign(other.read());
    return *this;
  }
  /// Transfers the elements and their memory. `other` is then empty.
  Array(Array&& other) noexcept
      : memory_(other.memory_),
        data_(std::exchange(other.data_, nullptr)),
        size_(std::exchange(other.size_, 0)),
        capacity_(std::exchange(other.capacity_, 0)) {}
  Array& operator=(Array&& other) noexcept {
    if (this == &other) return *this;
    release();
    memory_ = other.memory_;
    data_ = std::exchange(other.data_, nullptr);
    size_ = std::exchange(other.size_, 0);
    capacity_ = std::exchange(other.capacity_, 0);
    return *this;
  }
  ~Array() { release(); }

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  size_t capacity() const { return capacity_; }
  Memory& memory() const { return *memory_; }
  /// Bytes of its block, including those beyond the last element.
  size_t memory_bytes() const { return capacity_ * sizeof(T); }

  /// The elements for kernels that read them.
  View<const T> view() const { return {data_, static_cast<uint32_t>(size_)}; }
  /// The elements for kernels that write them.
  View<T> mutable_view() { return {data_, static_cast<uint32_t>(size_)}; }

  /// The elements for host code that reads them.
  std::span<const T> read() const {
    if (data_) memory_->open_for_reading(data_);
    return {data_, size_};
  }
  /// Lets host code read a few elements of the view until the next launch. read() is faster for all elements.
  void permit_reading() const {
    if (data_) memory_->permit_reading(data_);
  }
  /// The elements for host code that reads and writes them.
  std::span<T> write() {
    if (data_) memory_->open_for_writing(data_);
    return {data_, size_};
  }

  /// Replaces the content by `count` elements T{}. Allocates only if they do not fit.
  void reset(size_t count) {
    reset(count, kUninitialized);
    construct(0);
  }
  /// Replaces the content by `count` elements without a value.
  void reset(size_t count, Uninitialized) {
    if (count > capacity_) {
      check(count);
      T* const block = allocate(count);
      release();
      data_ = block;
      capacity_ = count;
    }
    size_ = count;
  }
  /// Sets the size. Keeps the first elements; new ones are T{}. Growth doubles the capacity.
  void resize(size_t count) {
    const size_t old = size_;
    resize(count, kUninitialized);
    construct(old);
  }
  /// The same, with uninitialised new elements.
  void resize(size_t count, Uninitialized) {
    if (count > capacity_) grow(count);
    size_ = count;
  }
  /// Replaces the content by copies of `values`, which must not be elements of this array.
  void assign(std::span<const T> values) {
    reset(values.size(), kUninitialized);
    copy(values, 0);
  }
  /// Replaces the content by `count` copies of `value`.
  void assign(size_t count, const T& value) {
    reset(count, kUninitialized);
    fill(value);
  }
  /// Sets all elements.
  void fill(const T& value) {
    const std::span<T> elements = write();
    std::fill(elements.begin(), elements.end(), value);
  }
  /// Adds copies of `values`, which must not be elements of this array, at the end.
  void append(std::span<const T> values) {
    const size_t old = size_;
    resize(old + values.size(), kUninitialized);
    copy(values, old);
  }
  void push_back(const T& value) {
    const T copy = value;
    if (size_ == capacity_) grow(size_ + 1);
    memory_->open_for_writing(data_);
    data_[size_++] = copy;
  }
  /// Removes all elements and keeps the block.
  void clear() { size_ = 0; }
  /// Allocates room for `count` elements, so that growth up to that number allocates nothing.
  void reserve(size_t count) {
    check(count);
    if (count > capacity_) move_to(count);
  }
  /// Gives back the memory beyond the last element.
  void shrink_to_fit() {
    if (capacity_ > size_) move_to(size_);
  }
  void swap(Array& other) noexcept { std::swap(*this, other); }

 private:
  static void check(size_t count) {
    if (count > kMaxSize) detail::fail_array_size(count);
  }
  T* allocate(size_t count) { return static_cast<T*>(memory_->allocate(count * sizeof(T), alignof(T))); }
  void release() noexcept {
    if (data_) memory_->deallocate(data_, capacity_ * sizeof(T), alignof(T));
    data_ = nullptr;
    size_ = capacity_ = 0;
  }
  void grow(size_t count) {
    check(count);
    move_to(size_ > 0 ? std::max(count, std::min(2 * capacity_, kMaxSize)) : count);
  }
  /// Moves the elements to a block for `capacity` elements. Changes nothing if it throws.
  void move_to(size_t capacity) {
    Array moved(*memory_);
    moved.reset(capacity, kUninitialized);
    if (size_ > 0) std::memcpy(static_cast<void*>(moved.write().data()), read().data(), size_ * sizeof(T));
    moved.size_ = size_;
    *this = std::move(moved);
  }
  /// Sets the elements from `first` on to T{}.
  void construct(size_t first) {
    if (first >= size_) return;
    const std::span<T> added = write().subspan(first);
    std::uninitialized_value_construct(added.begin(), added.end());
  }
  void copy(std::span<const T> values, size_t first) {
    if (!values.empty()) std::memcpy(static_cast<void*>(write().data() + first), values.data(), values.size_bytes());
  }

  Memory* memory_;
  T* data_ = nullptr;
  size_t size_ = 0;
  size_t capacity_ = 0;
};

/// One number or record that kernels access, such as a counter. Its value is T{} at first.
template <typename T>
class KernelValue {
 public:
  explicit KernelValue(Memory& memory = host_memory()) : element_(memory) { element_.reset(1); }

  /// The value for kernels that read and write it, as a view of one element.
  View<T> mutable_view() { return element_.mutable_view(); }
  /// The value for host code.
  const T& read() const { return element_.read()[0]; }
  /// The same for host code that changes it.
  T& write() { return element_.write()[0]; }

 private:
  Array<T> element_;
};

}  // namespace relume
