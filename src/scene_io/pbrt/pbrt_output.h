// Writes a pbrt file and the files in the folder beside it.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"
#include "scene_io/staged_files.h"

namespace relume::pbrt {

/// Shortest decimal form that reads back as the same float.
std::string number(float value);
/// "[ 1 2 3 ]".
std::string numbers(std::span<const float> values);
std::string numbers(const Vec3& v);
/// The columns of a matrix, as pbrt's Transform takes them.
std::string numbers(const Mat4& matrix);
/// In quotes, with escapes; control characters become spaces.
std::string in_quotes(std::string_view text);

/// A folder that is removed at the end if it was made and is empty.
class DataFolder {
 public:
  explicit DataFolder(std::filesystem::path path) : path_(std::move(path)) {}
  ~DataFolder();
  DataFolder(const DataFolder&) = delete;
  DataFolder& operator=(const DataFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Makes the folder unless it exists. Throws Error.
  void make();

 private:
  std::filesystem::path path_;
  bool is_made_ = false;
};

class Output {
 public:
  /// Creates the folder "STEM.pbrt-data" beside `file` with the first file in it. `sources` are never replaced. Throws
  /// Error for extensions other than .pbrt.
  Output(const std::filesystem::path& file, std::vector<std::filesystem::path> sources);

  /// Appends a line.
  void line(const std::string& text) { text_ += text + "\n"; }
  /// Adds an inexact part; equal sentences are kept once.
  void note(const std::string& sentence);
  std::string place() const { return file_.string(); }

  /// Adds a file to the folder. Returns its reference in quotes. `write` receives a temporary name. Throws Error.
  std::string add_file(const std::string& name, const std::function<void(const std::filesystem::path&)>& write);
  /// Adds a PNG of RGB bytes.
  std::string add_png(const std::string& name, std::span<const uint8_t> rgb, int width, int height);

  /// Writes the .pbrt file and renames all files to their final names. Returns the notes. Throws Error.
  std::vector<std::string> finish();

 private:
  std::filesystem::path file_;
  DataFolder folder_;  ///< outlives the temporary files
  StagedFiles staged_;
  std::string text_;
  std::vector<std::string> notes_;
  std::set<std::string> seen_;
};

}  // namespace relume::pbrt
