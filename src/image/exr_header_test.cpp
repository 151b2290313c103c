#include "image/exr_header.h"

#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <ImfAttribute.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gtest/gtest.h>

#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "relume/image_io.h"

namespace relume {
namespace {

const char* const kTypes[] = {"box2f",         "box2i",    "chlist",  "chromaticities",
                              "compression",   "double",   "envmap",  "float",
                              "floatvector",   "int",      "keycode", "lineOrder",
                              "m33d",          "m33f",     "m44d",    "m44f",
                              "preview",       "rational", "string",  "stringvector",
                              "tiledesc",      "timecode", "v2d",     "v2f",
                              "v2i",           "v3d",      "v3f",     "v3i",
                              "deepImageState"};

/// An EXR of one black pixel with an attribute of `type`, written by the library.
std::vector<std::byte> file_with(const char* type) {
  const TempFolder folder;
  Imf::Header header(1, 1);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  const std::unique_ptr<Imf::Attribute> attribute(Imf::Attribute::newAttribute(type));
  header.insert("probe", *attribute);
  float pixel = 0;
  Imf::FrameBuffer frame_buffer;
  frame_buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&pixel), sizeof(float), sizeof(float)));
  {
    Imf::OutputFile out((folder / "a.exr").string().c_str(), header);
    out.setFrameBuffer(frame_buffer);
    out.writePixels(1);
  }
  return read_file(folder / "a.exr");
}

/// Offset of the probe's size field.
size_t probe_size_at(const std::vector<std::byte>& bytes, const std::string& type) {
  const std::string key = std::string("probe") + '\0' + type + '\0';
  return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()).find(key) + key.size();
}

TEST(ExrHeader, AcceptsEveryAttributeThatTheLibraryWrites) {
  for (const char* type : kTypes) {
    const std::vector<std::byte> bytes = file_with(type);
    EXPECT_NO_THROW(detail::check_exr_header(bytes, type)) << type;
    EXPECT_NO_THROW(parse_exr(bytes, type)) << type;
  }
}

// The library reads as many bytes as the type needs and ignores the declared size. If the two differ, it misreads value
// bytes as the next attribute, or the reverse, and allocates by a garbage size.
TEST(ExrHeader, RejectsAttributesOfTheWrongSize) {
  for (const std::string type : kTypes) {
    if (type == "string") continue;  // any size is valid
    std::vector<std::byte> bytes = file_with(type.c_str());
    const size_t at = probe_size_at(bytes, type);
    uint32_t size = 0;
    std::memcpy(&size, bytes.data() + at, sizeof(size));
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at + sizeof(size) + size), std::byte{0});
    ++size;
    std::memcpy(bytes.data() + at, &size, sizeof(size));
    EXPECT_THROW(detail::check_exr_header(bytes, "a.exr"), Error) << type;
  }
}

}  // namespace
}  // namespace relume
