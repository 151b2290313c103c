#include "scene_io/pbrt/pbrt_output.h"

#include <charconv>
#include <system_error>

#include <fmt/format.h>

#include "files/extension.h"
#include "relume/error.h"
#include "relume/image_io.h"

namespace relume::pbrt {

std::string number(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return std::string(text, end);
}

std::string numbers(std::span<const float> values) {
  std::string text = "[ ";
  for (const float value : values) text += number(value) + " ";
  return text + "]";
}

std::string numbers(const Vec3& v) { return numbers(std::span(&v.x, 3)); }

std::string numbers(const Mat4& matrix) { return numbers(std::span(&matrix[0].x, 16)); }

std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += static_cast<unsigned char>(c) < 32 ? ' ' : c;
  }
  return result + "\"";
}

DataFolder::~DataFolder() {
  std::error_code not_empty;
  if (is_made_) std::filesystem::remove(path_, not_empty);
}

void DataFolder::make() {
  std::error_code error;
  is_made_ |= std::filesystem::create_directory(path_, error);
  if (error)
    throw Error(
        fmt::format("{}: the folder cannot be made ({}); choose another place", path_.string(), error.message()));
}

Output::Output(const std::filesystem::path& file, std::vector<std::filesystem::path> sources)
    : file_(file), folder_(file.parent_path() / (file.stem().string() + ".pbrt-data")), staged_(std::move(sources)) {
  if (lower_extension(file) != ".pbrt")
    throw Error(fmt::format("{}: scenes of pbrt have the extension .pbrt; choose it", file.string()));
}

void Output::note(const std::string& sentence) {
  if (seen_.insert(sentence).second) notes_.push_back(place() + ": " + sentence);
}

std::string Output::add_file(const std::string& name, const std::function<void(const std::filesystem::path&)>& write) {
  folder_.make();
  staged_.write(folder_.path() / name, write);
  return in_quotes((folder_.path().filename() / name).generic_string());
}

std::string Output::add_png(const std::string& name, std::span<const uint8_t> rgb, int width, int height) {
  const std::vector<uint8_t> png = encode_png(rgb, width, height);
  return add_file(name, [&](const std::filesystem::path& file) {
    write_file(file, {reinterpret_cast<const char*>(png.data()), png.size()});
  });
}

std::vector<std::string> Output::finish() {
  staged_.write(file_, [&](const std::filesystem::path& file) { write_file(file, text_); });
  staged_.commit();
  return std::move(notes_);
}

}  // namespace relume::pbrt
