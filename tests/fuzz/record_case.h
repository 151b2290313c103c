// Records that the program writes and reads, besides images, settings and checkpoints.
#pragma once

#include <filesystem>
#include <optional>

#include "checkpoint_case.h"
#include "compare/reference.h"

namespace relume::fuzz {

/// First byte of an input.
enum class RecordKind : int { summary, traces, reference, bookmarks, script };
inline constexpr int kRecordKinds = 5;

/// References of 4 × 3 pixels, stored in `folder`.
struct SmallReference {
  explicit SmallReference(const std::filesystem::path& folder) : renderer(scene, checkpoint_settings(0), 2, folder) {}

  std::filesystem::path file() const { return renderer.file(0, 0, std::nullopt); }
  std::optional<Reference> render() { return renderer.render(0, {}, {}); }

  const Scene scene = turning_triangle();
  ReferenceRenderer renderer;
};

}  // namespace relume::fuzz
