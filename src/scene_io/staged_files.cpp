#include "scene_io/staged_files.h"

#include <fmt/format.h>

#include "relume/error.h"

namespace relume {

void StagedFiles::write(const std::filesystem::path& target,
                        const std::function<void(const std::filesystem::path&)>& write) {
  for (const std::filesystem::path& source : sources_) {
    std::error_code missing;
    if (std::filesystem::equivalent(source, target, missing)) {
      throw Error(
          fmt::format("{}: the scene was read from this file, which would be replaced; choose another name or "
                      "folder for the output",
                      target.string()));
    }
  }
  const PendingFile& staged = staged_.emplace_back(target);
  try {
    write(staged.path());
  } catch (const Error& error) {
    std::string sentence = error.what();  // names the temporary file
    const std::string name = staged.path().string();
    if (const size_t at = sentence.find(name); at != std::string::npos)
      sentence.replace(at, name.size(), target.string());
    throw Error(sentence);
  }
}

void StagedFiles::commit() {
  for (PendingFile& staged : staged_) staged.commit();
}

}  // namespace relume
