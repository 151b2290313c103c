// Files that belong together, written under temporary names.
#pragma once

#include <filesystem>
#include <functional>
#include <list>
#include <vector>

#include "files/atomic_file.h"

namespace relume {

/// Files of an exported scene. Until commit(), existing files stay intact.
class StagedFiles {
 public:
  /// `sources` are never replaced.
  explicit StagedFiles(std::vector<std::filesystem::path> sources) : sources_(std::move(sources)) {}

  /// Stages a file that `write` writes under a temporary name. Throws Error that names `target`, also if `target` is a
  /// source.
  void write(const std::filesystem::path& target, const std::function<void(const std::filesystem::path&)>& write);

  /// Renames all files to their targets, in the order of write(). Throws Error.
  void commit();

 private:
  std::vector<std::filesystem::path> sources_;
  std::list<PendingFile> staged_;
};

}  // namespace relume
