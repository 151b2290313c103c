#include "parts/part_info.h"

#include <charconv>
#include <optional>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framebuffer/pixel_sums.h"
#include "relume/error.h"
#include "render/sample_parts.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

/// Content of the attribute relume.sums. It has the size of blocks: sums with other blocks have other bits.
std::string sums_text(bool surface) {
  return fmt::format("{} in blocks of {}", surface ? "radiance,surface" : "radiance", kBlockSamples);
}

std::string text_of(const Attributes& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? std::string() : found->second;
}

[[noreturn]] void refuse_attribute(const std::string& file, const std::string& name) {
  throw Error(fmt::format("{}: the attribute {} is damaged; render the part again", file, name));
}

uint32_t number_of(const Attributes& attributes, const std::string& file, const std::string& name, uint32_t missing) {
  const std::string text = text_of(attributes, name);
  if (text.empty()) return missing;
  uint32_t number = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc{} || end != text.data() + text.size()) refuse_attribute(file, name);
  return number;
}

/// Settings from the metadata. Throws Error if the program that wrote them has other settings.
AllSettings settings_of(const Attributes& attributes, const std::string& file) {
  AllSettings settings;
  settings_from_json(describe(settings), text_of(attributes, "relume.settings"), file);
  return settings;
}

[[noreturn]] void refuse_without_sums(const Attributes& attributes, const std::string& file) {
  if (!attributes.contains("relume.settings"))
    throw Error(fmt::format("{}: it is no image that relume rendered; merge parts of render --sample-range", file));
  const std::string reason = sums_refusal(settings_of(attributes, file).render);
  if (!reason.empty()) throw Error(fmt::format("{}: it cannot be merged: {}", file, reason));
  throw Error(
      fmt::format("{}: it has no sums of samples; render it with --sample-range, or merge it with --keep-sums", file));
}

/// Whether the attribute relume.sums names sums of surfaces.
bool has_surface(const std::string& sums, const std::string& file) {
  if (sums == sums_text(true)) return true;
  if (sums == sums_text(false)) return false;
  if (!sums.starts_with("radiance")) refuse_attribute(file, kSumsAttribute);
  throw Error(fmt::format("{}: it has sums of another version of relume ('{}', not '{}'); render the part again", file,
                          sums, sums_text(false)));
}

/// Settings that samples depend on. The number of threads, the form of kernels and the device change no bits.
RenderSettings relevant(RenderSettings settings) {
  settings.threads = 0;
  settings.scalar_kernels = false;
  settings.device = "cpu";
  return settings;
}

}  // namespace

Attributes part_attributes(const RenderedSamples& rendered, bool surface) {
  const SampleRange range{rendered.first, rendered.first + rendered.count - 1};
  Attributes attributes{{kSumsAttribute, sums_text(surface)},
                        {kSamplesAttribute, SampleRanges(range).to_string()},
                        {kCorrelatedAttribute, std::to_string(rendered.correlated_frames)}};
  if (rendered.adapt) attributes[kReplicasAttribute] = "1";
  return attributes;
}

PartInfo read_part_info(const Attributes& attributes, const std::string& file) {
  if (!attributes.contains(kSumsAttribute)) refuse_without_sums(attributes, file);
  PartInfo info;
  info.version = text_of(attributes, "relume.version");
  info.scene_hash = text_of(attributes, "relume.scene_hash");
  info.crop = text_of(attributes, "relume.crop");
  info.surface = has_surface(text_of(attributes, kSumsAttribute), file);
  const std::optional<SampleRanges> samples = SampleRanges::parse(text_of(attributes, kSamplesAttribute));
  if (!samples) refuse_attribute(file, kSamplesAttribute);
  info.samples = *samples;
  info.correlated_frames = number_of(attributes, file, kCorrelatedAttribute, 1);
  info.replicas = number_of(attributes, file, kReplicasAttribute, 0);
  info.settings = settings_of(attributes, file);
  return info;
}

std::string difference(const PartInfo& a, const std::string& a_file, const PartInfo& b, const std::string& b_file) {
  if (a.version != b.version) {
    return fmt::format("{} is of relume {}, but {} of {}; render all parts with one version", b_file, b.version, a_file,
                       a.version);
  }
  if (a.scene_hash != b.scene_hash)
    return fmt::format("{} and {} show different scenes; merge parts of one scene", a_file, b_file);
  RenderSettings left = relevant(a.settings.render);
  RenderSettings right = relevant(b.settings.render);
  const SettingList left_list = describe(left);
  const SettingList right_list = describe(right);
  if (const std::vector<const Setting*> others = differing_settings(left_list, right_list); !others.empty()) {
    const Setting& setting = *others.front();
    return fmt::format("{} has {} '{}', but {} has '{}'; render all parts with the same settings", a_file, setting.name,
                       to_string(setting), b_file, to_string(require_setting(right_list, setting.name, b_file)));
  }
  if (a.crop != b.crop) return fmt::format("{} and {} show different windows; use the same --crop", a_file, b_file);
  if (a.surface != b.surface || (a.replicas == 0) != (b.replicas == 0))
    return fmt::format("{} and {} have different layers; use the same --aov", a_file, b_file);
  return {};
}

Attributes merged_attributes(Attributes attributes, const PartInfo& merged, bool keep_sums) {
  AllSettings settings = merged.settings;
  settings.stop.spp = static_cast<int>(merged.samples.count());
  attributes["relume.settings"] = settings_to_json(describe(settings));
  attributes["relume.samples_per_pixel"] = std::to_string(merged.samples.count());
  attributes[kSamplesAttribute] = merged.samples.to_string();
  attributes[kCorrelatedAttribute] = std::to_string(merged.correlated_frames);
  if (merged.replicas > 0) attributes[kReplicasAttribute] = std::to_string(merged.replicas);
  if (!keep_sums) attributes.erase(kSumsAttribute);
  return attributes;
}

std::string add_timings(const std::string& a, const std::string& b) {
  const nlohmann::ordered_json left = nlohmann::ordered_json::parse(a, nullptr, false);
  const nlohmann::ordered_json right = nlohmann::ordered_json::parse(b, nullptr, false);
  if (!left.is_object() || !right.is_object()) return a;
  std::string text;
  for (const auto& [name, seconds] : left.items()) {
    if (!seconds.is_number() || !right.contains(name) || !right[name].is_number()) continue;
    text += fmt::format("{}\"{}\": {:.6f}", text.empty() ? "" : ", ", name,
                        seconds.get<double>() + right[name].get<double>());
  }
  return "{" + text + "}";
}

}  // namespace relume
