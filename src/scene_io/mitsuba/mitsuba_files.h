// Finds the files that a Mitsuba scene references.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace relume::mitsuba {

class Files {
 public:
  /// `root`: the scene file's folder, which no reference leaves.
  explicit Files(std::filesystem::path root) : root_(std::move(root)), folders_{root_} {}

  /// Adds a folder to the search (<path>), relative to `base`. Returns whether it lies in the scene's folder.
  /// Throws Error with the problem alone, for more folders than real scenes have.
  bool add_folder(const std::filesystem::path& base, std::string_view folder);

  /// File that a document in the folder `base` references: as written, relative to `base`, to the folders of <path> and
  /// to the scene's folder. Otherwise by name in the scene's folder and in its folder "textures", since paths may be
  /// from another machine. If none exists, the first candidate, whose absence is recorded by a read. std::nullopt for a
  /// reference without a usable name.
  std::optional<std::filesystem::path> find(const std::filesystem::path& base, std::string_view reference) const;
  std::optional<std::filesystem::path> find(std::string_view reference) const { return find(root_, reference); }

  const std::filesystem::path& root() const { return root_; }

 private:
  bool contains(const std::filesystem::path& path) const;

  std::filesystem::path root_;
  std::vector<std::filesystem::path> folders_;  ///< in order of search
};

}  // namespace relume::mitsuba
