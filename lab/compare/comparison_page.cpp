#include "compare/comparison_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compare/ranking.h"
#include "metrics/statistics.h"
#include "render/display.h"
#include "report/images.h"
#include "settings/nearest_name.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr size_t kMostValueBytes = 100u << 20;

/// Median over the repetitions at each point; the shortest repetition ends the curve.
Curve median_curve(const ContenderResult& contender, int color, double (*x)(const ErrorPoint&),
                   double (*y)(const ErrorPoint&)) {
  Curve curve{.name = contender.name, .color = color, .points = {}};
  size_t count = contender.repetitions.front().curve.size();
  for (const Repetition& repetition : contender.repetitions) count = std::min(count, repetition.curve.size());
  for (size_t i = 0; i < count; ++i) {
    std::vector<double> xs;
    std::vector<double> ys;
    for (const Repetition& repetition : contender.repetitions) {
      xs.push_back(x(repetition.curve[i]));
      ys.push_back(y(repetition.curve[i]));
    }
    CurvePoint point{.x = median(xs), .y = median(ys)};
    if (ys.size() > 2) {
      const Interval interval = median_interval(ys);
      point.low = interval.low;
      point.high = interval.high;
    }
    curve.points.push_back(point);
  }
  return curve;
}

Chart make_chart(const Comparison& c, std::string label, std::string x_label, std::string y_label,
                 double (*x)(const ErrorPoint&), double (*y)(const ErrorPoint&), double reference_noise) {
  Chart chart{std::move(label), std::move(x_label), std::move(y_label), !is_animation(c.options), true, {}};
  double low = INFINITY;
  double high = -INFINITY;
  for (size_t i = 0; i < c.contenders.size(); ++i) {
    if (c.contenders[i].is_image) continue;
    chart.curves.push_back(median_curve(c.contenders[i], static_cast<int>(i), x, y));
    for (const CurvePoint& point : chart.curves.back().points) {
      low = std::min(low, point.x);
      high = std::max(high, point.x);
    }
  }
  if (reference_noise > 0 && low < high)
    chart.curves.push_back(
        {"noise of the reference", kNeutralColor, true, {{low, reference_noise}, {high, reference_noise}}});
  return chart;
}

std::string names_text(const std::vector<ContenderResult>& contenders) {
  std::vector<std::string> names;
  for (const ContenderResult& contender : contenders) names.push_back(contender.name);
  return enumerate(names);
}

/// "width = 40, lights = uniform"
std::string settings_text(const SettingTexts& settings) {
  std::string text;
  for (const auto& [name, value] : settings) text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", name, value);
  return text;
}

std::string budget_text(const Comparison& c) {
  if (c.threads == 0) return "images from files";
  const bool animation = is_animation(c.options);
  if (c.options.budget_s > 0) {
    const double ms = 1000 * c.options.budget_s;
    return fmt::format("equal time, {}{}",
                       ms < 1000 ? fmt::format("{:.4g} ms", ms) : fmt::format("{:.4g} s", ms / 1000),
                       animation ? " per frame" : "");
  }
  return fmt::format("equal samples, {} per pixel{}", c.options.spp, animation ? " and frame" : "");
}

/// The contenders closest to the reference, as far as the repetitions distinguish them. `first`: leaders() by relMSE.
std::string closest_text(const Comparison& c, const std::vector<size_t>& first) {
  if (first.empty()) return "Every contender has pixels that are not finite, so none is ranked.";
  const auto name_of = [&](size_t i) { return c.contenders[i].name; };
  const auto value_of = [&](size_t i) { return short_number(median_of(c.contenders[i], &Repetition::rel_mse)); };
  if (std::count_if(c.contenders.begin(), c.contenders.end(), is_ranked) == 1)
    return fmt::format("{} has a relMSE of {}.", name_of(first[0]), value_of(first[0]));
  if (first.size() == 1)
    return fmt::format("{} is closest to the reference: relMSE {}.", name_of(first[0]), value_of(first[0]));
  std::vector<std::string> list;
  for (size_t i : first) list.push_back(fmt::format("{} (relMSE {})", name_of(i), value_of(i)));
  if (c.options.repetitions < 3) {
    return fmt::format("{} are not ranked: with fewer than three repetitions a difference may be chance.",
                       enumerate(list));
  }
  return fmt::format("{} are closest to the reference; their intervals overlap.", enumerate(list));
}

TextBlock summary(const Comparison& c) {
  const std::vector<size_t> first = leaders(c, &Repetition::rel_mse, true);
  TextBlock block{.title = "Summary", .text = closest_text(c, first), .points = c.notes};
  const double least = first.empty() ? 0 : median_of(c.contenders[first[0]], &Repetition::rel_mse);
  if (!(least > 0)) return block;
  std::vector<std::pair<double, std::string>> others;
  for (size_t i = 0; i < c.contenders.size(); ++i) {
    const bool is_leader = std::find(first.begin(), first.end(), i) != first.end();
    if (is_leader || !is_ranked(c.contenders[i])) continue;
    others.emplace_back(median_of(c.contenders[i], &Repetition::rel_mse) / least, c.contenders[i].name);
  }
  std::stable_sort(others.begin(), others.end());
  const std::string unit = first.size() == 1 ? "" : " as " + c.contenders[first[0]].name;
  for (size_t i = 0; i < others.size(); ++i) {
    block.text += i == 0 ? " By the same measure, " : "; ";
    block.text += fmt::format("{} has {} times as much{}", others[i].second, short_number(others[i].first), unit);
  }
  if (!others.empty()) block.text += ".";
  return block;
}

std::string reference_text(const Comparison& c) {
  const Reference& r = c.reference;
  if (r.spp == 0) return c.options.reference_file.string();
  const std::string own = settings_text(c.options.reference_settings);
  return fmt::format(
      "{} samples per pixel, {}; the techniques of preset reference{}; expected MSE {} and relMSE {}, from two halves "
      "with independent seeds",
      r.spp, r.cached ? "from the cache" : fmt::format("rendered in {:.1f} s", r.render_s),
      own.empty() ? "" : " with " + own, short_number(c.reference_noise.mse), short_number(c.reference_noise.rel_mse));
}

DetailsBlock how_it_was_made(const Comparison& c, const std::vector<std::pair<std::string, std::string>>& machine) {
  DetailsBlock block{.title = "Method", .text = {}, .pairs = machine, .parts = {}};
  const Reference& r = c.reference;
  const std::string common = settings_text(c.options.common.flags);
  const bool rendered = c.threads > 0;
  if (rendered) block.pairs.emplace_back("Threads", std::to_string(c.threads));
  block.pairs.emplace_back(
      "Scene", fmt::format("{}, {} triangles, hash {:016x}", c.options.scene_name, c.triangles, c.scene_hash));
  const std::string turns =
      fmt::format("; median of {} repetitions with separate seeds; the contenders take turns frame by frame",
                  c.options.repetitions);
  block.pairs.emplace_back("Comparison", budget_text(c) + (rendered ? turns : ""));
  block.pairs.emplace_back("Reference", reference_text(c));
  block.pairs.emplace_back("Common settings", common.empty() ? "the defaults" : common);
  if (!c.reference_left_out.empty() && r.spp > 0)
    block.pairs.emplace_back("Not for the reference", settings_text(c.reference_left_out));
  for (const ContenderResult& contender : c.contenders) {
    const std::string what = contender.is_image ? contender.settings : settings_text(contender.differences);
    block.pairs.emplace_back(contender.name, what.empty() ? "only the common settings" : what);
    if (!contender.is_image) block.parts.emplace_back("All settings of " + contender.name, contender.settings);
  }
  AllSettings reference_settings = c.reference_settings;
  if (r.spp > 0)
    block.parts.emplace_back("All settings of the reference", settings_to_json(describe(reference_settings)));
  return block;
}

}  // namespace

std::string short_number(double x) {
  if (!std::isfinite(x)) return "–";
  const bool all_digits = std::abs(x) >= 999.5 && std::abs(x) < 1e6;
  return all_digits ? fmt::format("{:.0f}", x) : fmt::format("{:.3g}", x);
}

ChartBlock comparison_curves(const Comparison& c) {
  const auto mse = [](const ErrorPoint& p) { return p.mse; };
  const auto rel_mse = [](const ErrorPoint& p) { return p.rel_mse; };
  const auto frames = [](const ErrorPoint& p) { return static_cast<double>(p.frames); };
  const auto samples = [](const ErrorPoint& p) { return p.samples; };
  const auto time_ms = [](const ErrorPoint& p) { return 1000 * p.time_s; };
  const double noise = c.reference_noise.mse;
  const double rel_noise = c.reference_noise.rel_mse;
  ChartBlock block{.title = is_animation(c.options) ? "Error along the animation" : "Convergence",
                   .text = "Medians over the repetitions; bands are their intervals.",
                   .charts = {}};
  if (is_animation(c.options)) {
    block.charts.push_back(make_chart(c, "relMSE", "frame", "relMSE", frames, rel_mse, rel_noise));
    block.charts.push_back(make_chart(c, "MSE", "frame", "MSE", frames, mse, noise));
    return block;
  }
  block.charts.push_back(make_chart(c, "relMSE by time", "time, ms", "relMSE", time_ms, rel_mse, rel_noise));
  block.charts.push_back(
      make_chart(c, "relMSE by samples", "samples per pixel", "relMSE", samples, rel_mse, rel_noise));
  block.charts.push_back(make_chart(c, "MSE by time", "time, ms", "MSE", time_ms, mse, noise));
  block.charts.push_back(make_chart(c, "MSE by samples", "samples per pixel", "MSE", samples, mse, noise));
  return block;
}

BarBlock comparison_frame_times(const Comparison& c) {
  BarBlock block{.title = "Frame time by pass", .text = "Medians over the repetitions.", .unit = "ms", .bars = {}};
  for (const ContenderResult& contender : c.contenders) {
    if (contender.is_image) continue;
    Bar bar{contender.name, {}};
    double sum = 0;
    for (const auto& [name, ms] : median_pass_ms(contender)) {
      if (ms > 0) bar.parts.emplace_back(name, ms);
      sum += ms;
    }
    const double rest = median_of(contender, frame_ms) - sum;
    if (rest > 0) bar.parts.emplace_back("between passes", rest);
    block.bars.push_back(std::move(bar));
  }
  return block;
}

ViewerBlock comparison_images(const Comparison& c) {
  const Image& reference = c.reference.image;
  const Display display = fixed_display(resolve(c.options.common).output);
  const size_t value_bytes = reference.pixels.size() * 6 * (c.contenders.size() + 1);
  const ImageOptions options{display.tone_map, display.exposure, value_bytes <= kMostValueBytes};
  const bool moves = is_animation(c.options);
  ViewerBlock block{.title = "Images",
                    .text = c.threads == 0 ? ""
                            : moves        ? "The last frame of the first repetition."
                                           : "Of the first repetition.",
                    .layers = image_layer_kinds(),
                    .sets = {}};
  std::vector<MeasuredImage> images;
  for (size_t i = 0; i < c.contenders.size(); ++i) {
    const ContenderResult& contender = c.contenders[i];
    const Repetition& first = contender.repetitions.front();
    const double rel_mse = first.curve.empty() ? first.rel_mse : first.curve.back().rel_mse;
    images.push_back(
        {contender.name, static_cast<int>(i), &contender.image, fmt::format("relMSE {}", short_number(rel_mse))});
  }
  block.sets.push_back(measured_set("image", reference, images, options));
  return block;
}

Page comparison_page(const Comparison& c, const std::vector<std::pair<std::string, std::string>>& machine) {
  Page page;
  page.title = fmt::format("{}: {}", c.options.scene_name, names_text(c.contenders));
  page.subtitle = fmt::format("{}×{} pixels, {}{}", c.reference.image.width, c.reference.image.height, budget_text(c),
                              is_animation(c.options) ? fmt::format(", {} frames", c.options.times_s.size()) : "");
  page.blocks = {summary(c), comparison_images(c), comparison_table(c)};
  const bool has_times =
      std::any_of(c.contenders.begin(), c.contenders.end(), [](const ContenderResult& r) { return !r.is_image; });
  if (has_times) {
    page.blocks.emplace_back(comparison_curves(c));
    page.blocks.emplace_back(comparison_frame_times(c));
  }
  page.blocks.emplace_back(how_it_was_made(c, machine));
  return page;
}

}  // namespace relume
