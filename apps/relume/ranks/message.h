// Messages between ranks as bytes. All ranks run the same version on processors of the same byte order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "relume/error.h"

namespace relume::ranks {

using Bytes = std::vector<std::byte>;

enum class MessageKind : uint32_t {
  // To the coordinator, which rank 0 runs.
  hello,     ///< the scene is loaded
  progress,  ///< of work in progress
  rendered,  ///< a deal, whose samples follow
  samples,   ///< sums of a deal
  result,    ///< of a task
  image,     ///< a frame of a sequence
  done,      ///< of a segment
  failed,    ///< the rank cannot work
  closed,    ///< the rank's last message, which its link keeps to itself
  // To the rank's worker.
  deal,
  cancel,  ///< the deal is no longer needed
  finish,  ///< no work is left
  end,     ///< all output is written
  shared,  ///< data of rank 0 for all
};

inline bool is_for_coordinator(MessageKind kind) { return kind < MessageKind::deal; }

/// Whether the message overtakes earlier ones of its rank that wait to be sent. All others keep their order.
inline bool is_urgent(MessageKind kind) { return kind == MessageKind::progress || kind == MessageKind::rendered; }

struct Message {
  int from = 0;
  MessageKind kind = MessageKind::hello;
  Bytes content = {};
  std::shared_ptr<const void> reservation = {};  ///< of ReceiveBudget, for a large message of another rank
};

class MessageWriter {
 public:
  template <typename T>
  MessageWriter& put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    return put_bytes(std::as_bytes(std::span(&value, 1)));
  }
  MessageWriter& put_bytes(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  MessageWriter& put_text(std::string_view text) {
    put(static_cast<uint64_t>(text.size()));
    return put_bytes(std::as_bytes(std::span(text.data(), text.size())));
  }
  void reserve(size_t bytes) { bytes_.reserve(bytes); }
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

/// Throws Error where a message ends early.
class MessageReader {
 public:
  explicit MessageReader(const Bytes& bytes) : rest_(bytes) {}

  template <typename T>
  T get() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, get_bytes(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string get_text() {
    const std::span<const std::byte> text = get_bytes(get<uint64_t>());
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }
  std::span<const std::byte> get_bytes(uint64_t size) {
    if (size > rest_.size()) throw Error("a message between ranks is incomplete; all ranks must run the same relume");
    const std::span<const std::byte> bytes = rest_.first(size);
    rest_ = rest_.subspan(size);
    return bytes;
  }

 private:
  std::span<const std::byte> rest_;
};

}  // namespace relume::ranks
