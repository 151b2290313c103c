#include "image/ktx2/testing/ktx2_file.h"

#include <string_view>

#include <zstd.h>

#include "image/ktx2/testing/uastc_block.h"

namespace relume::testing {
namespace {

using Bytes = std::vector<std::byte>;

void put(uint64_t value, size_t size, Bytes& bytes) {
  for (size_t i = 0; i < size; ++i, value >>= 8) bytes.push_back(static_cast<std::byte>(value));
}

void append(const Bytes& more, Bytes& bytes) { bytes.insert(bytes.end(), more.begin(), more.end()); }

void align(size_t alignment, Bytes& bytes) {
  while (bytes.size() % alignment != 0) bytes.push_back(std::byte{0});
}

Bytes descriptor(const Ktx2File& file) {
  const size_t size = 24 + 16 * file.channels.size();
  Bytes bytes;
  put(4 + size, 4, bytes);
  put(0, 4, bytes);
  put(2, 2, bytes);
  put(size, 2, bytes);
  for (const uint8_t field : {file.model, uint8_t{1}, file.transfer, file.flags}) put(field, 1, bytes);
  put(0, 12, bytes);
  for (const uint8_t channel : file.channels) {
    put(0, 2, bytes);
    put(7, 1, bytes);
    put(channel, 1, bytes);
    put(0, 12, bytes);
  }
  return bytes;
}

Bytes entries(const Ktx2File& file) {
  Bytes bytes;
  for (const auto& [key, value] : file.key_values) {
    put(key.size() + value.size() + 2, 4, bytes);
    for (const char c : key + '\0' + value + '\0') bytes.push_back(static_cast<std::byte>(c));
    align(4, bytes);
  }
  return bytes;
}

}  // namespace

Bytes Ktx2File::bytes() const {
  using namespace std::string_view_literals;
  const Bytes descriptor_bytes = descriptor(*this);
  const Bytes entry_bytes = entries(*this);
  const size_t index_end = 80 + 24 * levels.size();
  Bytes tail = descriptor_bytes;  // after the level index
  append(entry_bytes, tail);
  tail.resize(tail.size() + (8 - (index_end + tail.size()) % 8) % 8);
  const size_t global_at = index_end + tail.size();
  append(global_data, tail);
  std::vector<size_t> level_at(levels.size());
  for (size_t i = levels.size(); i > 0; --i) {
    level_at[i - 1] = index_end + tail.size();
    append(levels[i - 1], tail);
  }
  Bytes result;
  for (const char c : "\xabKTX 20\xbb\r\n\x1a\n"sv) result.push_back(static_cast<std::byte>(c));
  const auto level_count = static_cast<uint32_t>(levels.size());
  for (const uint32_t field : {format, 1u, width, height, depth, layers, faces, level_count, supercompression})
    put(field, 4, result);
  put(index_end, 4, result);
  put(descriptor_bytes.size(), 4, result);
  put(entry_bytes.empty() ? 0 : index_end + descriptor_bytes.size(), 4, result);
  put(entry_bytes.size(), 4, result);
  put(global_data.empty() ? 0 : global_at, 8, result);
  put(global_data.size(), 8, result);
  for (size_t i = 0; i < levels.size(); ++i) {
    put(level_at[i], 8, result);
    put(levels[i].size(), 8, result);
    put(uncompressed_bytes[i], 8, result);
  }
  append(tail, result);
  return result;
}

Bytes byte_list(const std::vector<int>& values) {
  Bytes bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

Bytes zstandard(const Bytes& bytes) {
  Bytes result(ZSTD_compressBound(bytes.size()));
  result.resize(ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), 3));
  return result;
}

Ktx2File plain_ktx2() {
  Ktx2File file;
  file.levels = {byte_list({10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25})};
  return file;
}

Ktx2File uastc_ktx2() {
  Ktx2File file;
  file.format = 0;
  file.width = 8;
  file.height = 8;
  file.model = 166;
  file.channels = {3};
  file.levels.resize(1);
  for (uint8_t i = 0; i < 4; ++i) {
    UastcBlock block;
    block.mode = 8;
    block.solid = {static_cast<uint8_t>(60 + i), static_cast<uint8_t>(70 + i), static_cast<uint8_t>(80 + i),
                   static_cast<uint8_t>(90 + i)};
    append(write_uastc_block(block), file.levels[0]);
  }
  file.uncompressed_bytes = {64};
  return file;
}

Ktx2File with_zstandard(Ktx2File file) {
  file.supercompression = 2;
  file.levels[0] = zstandard(file.levels[0]);
  return file;
}

Ktx2File etc1s_ktx2(const Etc1sCodebooks& codebooks, const std::vector<Etc1sBlocks>& images, uint32_t width,
                    uint32_t height) {
  const Etc1sStreams streams = write_etc1s(codebooks, images);
  Ktx2File file;
  file.format = 0;
  file.width = width;
  file.height = height;
  file.supercompression = 1;
  file.model = 163;
  file.channels = {0};
  if (images.size() > 1) file.channels.push_back(15);
  file.uncompressed_bytes = {0};
  file.levels = {streams.slices[0]};
  if (images.size() > 1) append(streams.slices[1], file.levels[0]);
  put(codebooks.endpoints.size(), 2, file.global_data);
  put(codebooks.selectors.size(), 2, file.global_data);
  for (const Bytes* section : {&streams.endpoints, &streams.selectors, &streams.tables})
    put(section->size(), 4, file.global_data);
  put(0, 8, file.global_data);  // no extended data; no image flags
  put(0, 4, file.global_data);
  put(streams.slices[0].size(), 4, file.global_data);
  put(images.size() > 1 ? streams.slices[0].size() : 0, 4, file.global_data);
  put(images.size() > 1 ? streams.slices[1].size() : 0, 4, file.global_data);
  for (const Bytes* section : {&streams.endpoints, &streams.selectors, &streams.tables})
    append(*section, file.global_data);
  return file;
}

Ktx2File small_etc1s_ktx2(bool alpha) {
  Etc1sCodebooks codebooks;
  codebooks.endpoints = {{{31, 0, 10}, 2}, {{0, 16, 31}, 0}, {{8, 8, 8}, 7}, {{20, 20, 20}, 4}};
  codebooks.selectors = {{0x1b, 0xe4, 0x00, 0xff}, {0xaa, 0xaa, 0x55, 0x55}, {0x12, 0x34, 0x56, 0x78}};
  const Etc1sBlocks rgb{3, 2, {0, 0, 1, 0, 1, 0}, {0, 1, 1, 1, 1, 2}};
  const Etc1sBlocks grey{3, 2, {2, 3, 3, 2, 2, 3}, {2, 2, 0, 1, 0, 2}};
  return alpha ? etc1s_ktx2(codebooks, {rgb, grey}, 9, 7) : etc1s_ktx2(codebooks, {rgb}, 9, 7);
}

}  // namespace relume::testing
