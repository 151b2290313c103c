// KTX2 files with individually settable fields, for tests.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "image/ktx2/testing/etc1s_writer.h"

namespace relume::testing {

/// A file, by default with one level of RGBA.
struct Ktx2File {
  uint32_t format = 43;  ///< VkFormat: 37 RGBA linear, 43 RGBA sRGB, 0 undefined
  uint32_t width = 2;
  uint32_t height = 2;
  uint32_t depth = 0;
  uint32_t layers = 0;
  uint32_t faces = 1;
  uint32_t supercompression = 0;
  uint8_t model = 1;                              ///< 1 RGB, 163 ETC1S, 166 UASTC
  uint8_t transfer = 2;                           ///< 1 linear, 2 sRGB
  uint8_t flags = 0;                              ///< 1 premultiplied alpha
  std::vector<uint8_t> channels = {0, 1, 2, 15};  ///< channels of the samples
  std::vector<std::pair<std::string, std::string>> key_values;
  std::vector<std::byte> global_data;
  std::vector<std::vector<std::byte>> levels;       ///< largest first
  std::vector<uint64_t> uncompressed_bytes = {16};  ///< one per level

  std::vector<std::byte> bytes() const;
};

/// Bytes of these values.
std::vector<std::byte> byte_list(const std::vector<int>& values);

/// `bytes` as one Zstandard frame.
std::vector<std::byte> zstandard(const std::vector<std::byte>& bytes);

/// A file of 2 × 2 texels with the 16 channel values 10, 11, 12, …
Ktx2File plain_ktx2();
/// A UASTC file of 8 × 8 texels in four blocks of one colour each: (60, 70, 80, 90), (61, 71, 81, 91), …
Ktx2File uastc_ktx2();
/// Compresses the only level of the file with Zstandard.
Ktx2File with_zstandard(Ktx2File file);

/// A BasisLZ file with RGB in its first image and, optionally, alpha in a second. `width` and `height` are in texels.
Ktx2File etc1s_ktx2(const Etc1sCodebooks& codebooks, const std::vector<Etc1sBlocks>& images, uint32_t width,
                    uint32_t height);
/// A BasisLZ file with 9 × 7 texels, four endpoints and three selectors.
Ktx2File small_etc1s_ktx2(bool alpha);

}  // namespace relume::testing
