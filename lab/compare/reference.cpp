#include "compare/reference.h"

#include <array>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "core/clock.h"
#include "core/fnv1a.h"
#include "files/atomic_file.h"
#include "relume/error.h"
#include "relume/lab/metrics.h"
#include "scene/scene_hash.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

/// Part of the name of cached files; must change whenever the references would.
constexpr uint64_t kFormat = 1;
/// Seeds outside the setting's range, so that references are independent of the compared images.
constexpr std::array<int, 2> kSeeds{1'000'000'007, 1'000'000'021};
constexpr double kCheckpointInterval_s = 30;

void estimate_error(const Image& a, const Image& b, Reference& reference) {
  // Var(a - b) is twice the variance of a half, which is twice that of the mean.
  double squared = 0;
  double relative = 0;
  uint64_t count = 0;
  reference.image = Image(a.width, a.height);
  reference.squared_error = Image(a.width, a.height);
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const Rgb mean = 0.5f * (a.pixels[i] + b.pixels[i]);
    reference.image.pixels[i] = mean;
    const Rgb difference = a.pixels[i] - b.pixels[i];
    if (!is_finite(difference)) continue;
    ++count;
    reference.squared_error.pixels[i] = 0.25f * difference * difference;
    for (int c = 0; c < 3; ++c) {
      const double square = double(difference[c]) * difference[c] / 4;
      squared += square;
      relative += square / (double(mean[c]) * mean[c] + kRelativeEpsilon);
    }
  }
  reference.mse = squared / (3.0 * static_cast<double>(count));
  reference.rel_mse = relative / (3.0 * static_cast<double>(count));
}

const std::vector<float>& plane(const std::vector<ExrChannel>& channels, std::string_view name,
                                const std::string& place) {
  for (const ExrChannel& channel : channels) {
    if (channel.name == name) return channel.values;
  }
  throw Error(fmt::format("{}: there is no channel {}; delete the file to render it again", place, name));
}

SurfaceMotion surface_from(const std::vector<ExrChannel>& channels, const std::string& place) {
  const auto& mx = plane(channels, "motion.X", place);
  const auto& my = plane(channels, "motion.Y", place);
  const auto& nx = plane(channels, "normal.X", place);
  const auto& ny = plane(channels, "normal.Y", place);
  const auto& nz = plane(channels, "normal.Z", place);
  SurfaceMotion surface;
  surface.depth = plane(channels, "depth.Z", place);
  for (size_t i = 0; i < mx.size(); ++i) {
    surface.motion.emplace_back(mx[i], my[i]);
    surface.normal.emplace_back(nx[i], ny[i], nz[i]);
  }
  return surface;
}

void save(const std::filesystem::path& file, const Image& a, const Image& b, const Reference& reference,
          std::vector<ExrChannel> surface, const RenderSettings& settings) {
  ExrFile exr{a.width, a.height, exr_channels(reference.image), {}};
  for (ExrChannel& channel : exr_channels(a, "a")) exr.channels.push_back(std::move(channel));
  for (ExrChannel& channel : exr_channels(b, "b")) exr.channels.push_back(std::move(channel));
  for (ExrChannel& channel : surface) exr.channels.push_back(std::move(channel));
  RenderSettings copy = settings;
  exr.attributes = {{"relume.settings", settings_to_json(describe(copy))},
                    {"relume.samples_per_pixel", std::to_string(reference.spp)}};
  write_exr(file, exr);
}

/// Checkpoint of half 0 or 1 of a reference that `file` will hold.
std::filesystem::path checkpoint_of(std::filesystem::path file, int half) {
  return file.replace_extension(half == 0 ? ".a.ckpt" : ".b.ckpt");
}

}  // namespace

Image read_whole_image(const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = read_file(file);
  if (const PixelWindow w = stored_window(bytes, file.string()); !w.empty())
    throw Error(fmt::format("{}: the file stores only the window {},{},{},{} of its image; render it without --crop",
                            file.string(), w.x, w.y, w.width, w.height));
  return parse_image(bytes, file.string());
}

Reference read_reference(const std::filesystem::path& file) {
  Reference reference;
  reference.image = read_whole_image(file);
  return reference;
}

ReferenceRenderer::ReferenceRenderer(const Scene& scene, const RenderSettings& settings, int spp,
                                     std::filesystem::path folder, std::string program)
    : scene_(scene),
      settings_(settings),
      half_spp_(std::max(1, (spp + 1) / 2)),
      folder_(std::move(folder)),
      program_(std::move(program)),
      scene_hash_(relume::scene_hash(scene)) {
  settings_.auxiliary = true;
  settings_.seed = 0;
  std::error_code failure;
  std::filesystem::create_directories(folder_, failure);
  if (failure) {
    throw Error(fmt::format("{}: the folder for references cannot be created ({}); choose another", folder_.string(),
                            failure.message()));
  }
  const PendingFile probe(folder_ / "reference.exr");  // fails now rather than after hours
}

std::filesystem::path ReferenceRenderer::file(float time_s, float previous_time_s,
                                              const std::optional<CameraPose>& camera) const {
  RenderSettings copy = settings_;
  copy.threads = 0;
  copy.scalar_kernels = false;
  copy.time_s = time_s;
  const std::string text = settings_to_json(describe(copy));
  Fnv1a key(kFormat);
  key.add(text.data(), text.size());
  key.add(program_.data(), program_.size());
  key.add(&scene_hash_, sizeof scene_hash_);
  key.add(&half_spp_, sizeof half_spp_);
  key.add(&previous_time_s, sizeof previous_time_s);
  if (camera) {
    key.add(&camera->to_world, sizeof camera->to_world);
    const Camera& c = camera->camera;
    const std::array<float, 5> lens{static_cast<float>(c.projection), c.fov_y_rad, c.half_height, c.lens_radius,
                                    c.focus_distance};
    key.add(lens.data(), sizeof lens);
  }
  return folder_ / fmt::format("reference-{:016x}.exr", key.value());
}

Session& ReferenceRenderer::session() {
  if (!session_) session_ = std::make_unique<Session>(scene_, settings_);
  return *session_;
}

bool ReferenceRenderer::render_samples(int half, const std::filesystem::path& checkpoint, const std::stop_token& stop,
                                       const ReferenceProgress& progress) {
  Session& s = session();
  if (std::error_code failure; std::filesystem::exists(checkpoint, failure)) s.load_checkpoint(checkpoint);
  double saved_s = now_s();
  const auto wanted = static_cast<uint32_t>(half_spp_);
  bool changed = false;
  while (s.frames_since_change() < wanted) {
    // Adaptive sampling completes a frame once it has begun.
    if (stop.stop_requested() || !s.render_frame(stop)) break;
    changed = true;
    if (progress) progress(static_cast<double>(s.frames_since_change()) / wanted);
    if (now_s() - saved_s > kCheckpointInterval_s) {
      s.save_checkpoint(checkpoint);
      saved_s = now_s();
      changed = false;
    }
  }
  if (changed && (s.frames_since_change() > 0) && (half == 0 || s.frames_since_change() < wanted))
    s.save_checkpoint(checkpoint);
  return s.frames_since_change() >= wanted;
}

std::optional<Reference> ReferenceRenderer::find(float time_s, float previous_time_s,
                                                 const std::optional<CameraPose>& camera) const {
  const std::filesystem::path target = file(time_s, previous_time_s, camera);
  if (std::error_code failure; !std::filesystem::exists(target, failure)) return std::nullopt;
  const ExrFile exr = read_exr(target);
  if (exr.width != settings_.width || exr.height != settings_.height) {
    throw Error(fmt::format("{}: this image has {} × {} pixels, not {} × {}; delete the file to render it again",
                            target.string(), exr.width, exr.height, settings_.width, settings_.height));
  }
  Reference reference;
  reference.spp = 2 * half_spp_;
  estimate_error(image_from_exr(exr, "a", target.string()), image_from_exr(exr, "b", target.string()), reference);
  reference.surface = surface_from(exr.channels, target.string());
  reference.cached = true;
  return reference;
}

std::optional<ReferenceHalf> ReferenceRenderer::render_half(int half, float time_s, float previous_time_s,
                                                            const std::optional<CameraPose>& camera,
                                                            const std::stop_token& stop,
                                                            const ReferenceProgress& progress) {
  Session& s = session();
  s.set_camera(camera);
  s.set_time(previous_time_s);
  s.restart(kSeeds[static_cast<size_t>(half)]);
  if (time_s != previous_time_s) s.set_time(time_s);
  if (!render_samples(half, checkpoint_of(file(time_s, previous_time_s, camera), half), stop, progress))
    return std::nullopt;
  ReferenceHalf result{.image = s.image()};
  if (half > 0) return result;
  for (const char* name : {"motion", "depth", "normal"}) {
    for (ExrChannel& channel : s.aov(name)) result.surface.push_back(std::move(channel));
  }
  return result;
}

Reference ReferenceRenderer::combine(float time_s, float previous_time_s, const std::optional<CameraPose>& camera,
                                     std::array<ReferenceHalf, 2> halves) const {
  const std::filesystem::path target = file(time_s, previous_time_s, camera);
  Reference reference;
  reference.spp = 2 * half_spp_;
  estimate_error(halves[0].image, halves[1].image, reference);
  reference.surface = surface_from(halves[0].surface, target.string());
  save(target, halves[0].image, halves[1].image, reference, std::move(halves[0].surface), settings_);
  remove_checkpoints(time_s, previous_time_s, camera);
  return reference;
}

void ReferenceRenderer::remove_checkpoints(float time_s, float previous_time_s,
                                           const std::optional<CameraPose>& camera) const {
  for (const int half : {0, 1}) {
    std::error_code ignored;
    std::filesystem::remove(checkpoint_of(file(time_s, previous_time_s, camera), half), ignored);
  }
}

std::optional<Reference> ReferenceRenderer::render(float time_s, float previous_time_s,
                                                   const std::optional<CameraPose>& camera, const std::stop_token& stop,
                                                   const ReferenceProgress& progress) {
  if (std::optional<Reference> known = find(time_s, previous_time_s, camera)) return known;
  const double start_s = now_s();
  std::array<ReferenceHalf, 2> halves;
  for (const int half : {0, 1}) {
    std::optional<ReferenceHalf> rendered =
        render_half(half, time_s, previous_time_s, camera, stop, [&](double fraction) {
          if (progress) progress(0.5 * half + 0.5 * fraction);
        });
    if (!rendered) return std::nullopt;
    halves[static_cast<size_t>(half)] = std::move(*rendered);
  }
  Reference reference = combine(time_s, previous_time_s, camera, std::move(halves));
  reference.render_s = now_s() - start_s;
  return reference;
}

}  // namespace relume
