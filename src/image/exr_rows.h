// EXR files read and written by rows, so that memory is bounded for any size of image. Channels may hold integers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "relume/image.h"

namespace relume {

struct ExrRowChannel {
  std::string name;
  bool is_integer = false;  ///< 32-bit unsigned integers instead of floats

  friend bool operator==(const ExrRowChannel&, const ExrRowChannel&) = default;
};

struct ExrLayout {
  int width = 0;  ///< of the image
  int height = 0;
  PixelWindow window = {};  ///< the stored pixels; never empty
  std::vector<ExrRowChannel> channels;
  std::map<std::string, std::string> attributes;
};

/// Reads the first part of a file. Rows count from the top of the stored window. Throws Error (file, problem, remedy).
class ExrRowReader {
 public:
  explicit ExrRowReader(const std::filesystem::path& file);
  ~ExrRowReader();
  ExrRowReader(ExrRowReader&&) noexcept;
  ExrRowReader& operator=(ExrRowReader&&) noexcept;

  const ExrLayout& layout() const;

  /// Rows [first, first + count) as words: channel by channel, row by row; floats by their bits.
  void read(int first, int count, std::span<uint32_t> words);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Writes scan lines with ZIP compression. Without commit(), the target is unchanged. Throws Error.
class ExrRowWriter {
 public:
  /// Throws Error if two channels have the same name.
  ExrRowWriter(const std::filesystem::path& file, const ExrLayout& layout);
  ~ExrRowWriter();

  /// The next `count` rows, as ExrRowReader::read() gives them, in the order of the layout's channels.
  void write(int count, std::span<const uint32_t> words);
  void commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace relume
