// Writes the seed corpora of the fuzzers: make_seeds FOLDER makes FOLDER/gltf, FOLDER/obj, …
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "io/image.h"
#include "io/testing/example_files.h"

namespace {

void write(const std::filesystem::path& file, const relume::Bytes& bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_seeds FOLDER\n");
    return 1;
  }
  const std::filesystem::path folder = argv[1];
  for (const relume::testing::ExampleFile& file : relume::testing::example_files()) {
    const std::string extension = std::filesystem::path(file.name).extension().string().substr(1);
    write(folder / (extension == "glb" ? "gltf" : extension) / file.name, file.bytes);
  }
  write(folder / "texture" / "solid.png", relume::testing::solid_png(3, 2, 1, 2, 3, 4));
  for (const char* name : {"a.exr", "a.hdr", "a.jpg", "a.tga"})
    relume::write_image(folder / "texture" / name, relume::Image(3, 2));
  return 0;
}
