// What the metadata of a part say: its samples, and what must be equal in parts that are merged.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "parts/sample_ranges.h"
#include "render/session.h"
#include "render/settings.h"

namespace relume {

using Attributes = std::map<std::string, std::string>;

/// Names of attributes that only parts have.
inline constexpr const char* kSumsAttribute = "relume.sums";
inline constexpr const char* kSamplesAttribute = "relume.samples";
inline constexpr const char* kCorrelatedAttribute = "relume.correlated_frames";
inline constexpr const char* kReplicasAttribute = "relume.replicas";

struct PartInfo {
  std::string version;     ///< of the program
  std::string scene_hash;  ///< Session::scene_hash()
  std::string crop;
  AllSettings settings;
  SampleRanges samples;
  bool surface = false;  ///< whether the file has sums of surfaces
  uint32_t correlated_frames = 1;
  uint32_t replicas = 0;  ///< number of independent renders, if samples adapt; otherwise 0
};

/// Attributes of a part with these samples, besides those of all images.
Attributes part_attributes(const RenderedSamples& rendered, bool surface);

/// Reads the attributes of `file`. Throws Error, with the reason if the settings allow no sums.
PartInfo read_part_info(const Attributes& attributes, const std::string& file);

/// Why the part `b` does not belong to the part `a`, both with the names of their files; empty if it does, or if only
/// their samples conflict.
std::string difference(const PartInfo& a, const std::string& a_file, const PartInfo& b, const std::string& b_file);

/// Attributes of the merged image. `merged` has those of the part with the first sample, except `samples`, `replicas`
/// and `correlated_frames`, which are those of all parts.
Attributes merged_attributes(Attributes attributes, const PartInfo& merged, bool keep_sums);

/// The sum of two texts of relume.timings, which are JSON objects of numbers.
std::string add_timings(const std::string& a, const std::string& b);

}  // namespace relume
