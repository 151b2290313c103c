#include "compare/comparison_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "metrics/statistics.h"
#include "report/pictures.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

using Value = double (*)(const Repetition&);

constexpr size_t kMostValueBytes = 100u << 20;

bool is_animation(const Comparison& c) { return c.options.times_s.size() > 1; }

/// Median with its interval below it.
TableCell median_cell(const ContenderResult& contender, Value value) {
  const std::vector<double> values = values_of(contender, value);
  const Interval interval = median_interval(values);
  TableCell cell{.text = short_number(median(values)), .value = median(values)};
  if (interval.confidence > 0)
    cell.note = fmt::format("{} – {}", short_number(interval.low), short_number(interval.high));
  return cell;
}

TableCell bias_cell(const ErrorSplit& split) {
  const bool is_noise = split.bias2 < 2 * split.bias2_error;
  return {.text = is_noise ? "≈ 0" : short_number(split.bias2),
          .value = std::max(split.bias2, 0.0),
          .note = fmt::format("± {}", short_number(2 * split.bias2_error))};
}

double rays_per_pixel(const Comparison& c, const ContenderResult& contender) {
  const double pixels = double(c.reference.image.width) * c.reference.image.height;
  return median_of(contender, [](const Repetition& r) { return static_cast<double>(r.rays); }) / pixels;
}

std::vector<TableColumn> table_columns(const Comparison& c) {
  std::vector<TableColumn> columns = {
      {"MSE", "Mean squared error of linear radiance against the reference.", Better::lower},
      {"relMSE", "Squared error over the squared reference + 0.01, so that dark places count as much as bright ones.",
       Better::lower},
      {"MAPE", "Mean of the error's size over the reference + 0.01.", Better::lower},
      {"FLIP", "What a viewer sees who flips between picture and reference, from 0 to 1 (Andersson 2020).",
       Better::lower},
      {"bias²",
       "Part of the MSE that more samples would not remove, from the mean over the repetitions; the reference's own "
       "noise is subtracted. Below it two standard errors.",
       Better::none},
      {"variance", "Part of the MSE that differs between repetitions.", Better::lower},
  };
  if (is_animation(c)) {
    columns.push_back({"temporal error",
                       "Flicker: how much the relative error changes from frame to frame on each surface, squared. "
                       "Motion and changes of the light do not count.",
                       Better::lower});
  }
  columns.push_back(
      {"samples", is_animation(c) ? "Paths a pixel, on average, all frames together." : "Paths a pixel, on average."});
  columns.push_back({"time, s", "Inside frames; loading, building and measuring do not count."});
  columns.push_back({"ms a frame", "Time over frames.", Better::lower});
  columns.push_back({"rays a pixel", "Path and shadow rays."});
  return columns;
}

TableRow contender_row(const Comparison& c, const ContenderResult& contender, int color) {
  TableRow row{.name = contender.name, .color = color, .cells = {}};
  for (Value value :
       {Value([](const Repetition& r) { return r.mse; }), Value([](const Repetition& r) { return r.rel_mse; }),
        Value([](const Repetition& r) { return r.mape; }), Value([](const Repetition& r) { return r.flip; })}) {
    row.cells.push_back(median_cell(contender, value));
  }
  row.cells.push_back(contender.split ? bias_cell(*contender.split) : TableCell{"–"});
  row.cells.push_back(contender.split ? TableCell{short_number(contender.split->variance), contender.split->variance}
                                      : TableCell{"–"});
  const size_t left = is_animation(c) ? 5 : 4;
  if (contender.is_picture) {
    row.cells.resize(row.cells.size() + left, TableCell{"–"});
    return row;
  }
  if (is_animation(c))
    row.cells.push_back(median_cell(contender, [](const Repetition& r) { return r.temporal_error; }));
  row.cells.push_back(median_cell(contender, [](const Repetition& r) { return r.samples; }));
  row.cells.push_back(median_cell(contender, [](const Repetition& r) { return r.time_s; }));
  row.cells.push_back(median_cell(contender, frame_ms));
  const double rays = rays_per_pixel(c, contender);
  row.cells.push_back({.text = short_number(rays), .value = rays});
  return row;
}

TableRow reference_row(const Comparison& c) {
  TableRow row{.name = "reference", .cells = {}, .competes = false};
  const size_t columns = table_columns(c).size();
  row.cells.assign(columns, TableCell{"–"});
  if (c.reference.spp == 0) return row;
  row.cells[0] = {.text = short_number(c.reference.mse), .value = c.reference.mse, .note = "its own noise"};
  row.cells[1] = {.text = short_number(c.reference.rel_mse), .value = c.reference.rel_mse, .note = "its own noise"};
  row.cells[is_animation(c) ? 7 : 6] = {.text = short_number(c.reference.spp), .value = c.reference.spp};
  return row;
}

/// Median over the repetitions at each point; a repetition that has fewer points ends the curve.
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
  Chart chart{std::move(label), std::move(x_label), std::move(y_label), !is_animation(c), true, {}};
  double low = INFINITY;
  double high = -INFINITY;
  for (size_t i = 0; i < c.contenders.size(); ++i) {
    if (c.contenders[i].is_picture) continue;
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

std::string join_names(const std::vector<ContenderResult>& contenders) {
  std::string text;
  for (size_t i = 0; i < contenders.size(); ++i) {
    if (i > 0) text += i + 1 == contenders.size() ? " and " : ", ";
    text += contenders[i].name;
  }
  return text;
}

std::string budget_text(const Comparison& c) {
  const bool animation = is_animation(c);
  if (c.options.budget_s > 0) {
    const double ms = 1000 * c.options.budget_s;
    return fmt::format("equal time, {}{}",
                       ms < 1000 ? fmt::format("{:.4g} ms", ms) : fmt::format("{:.4g} s", ms / 1000),
                       animation ? " a frame" : "");
  }
  return fmt::format("equal samples, {} a pixel{}", c.options.spp, animation ? " and frame" : "");
}

TextBlock summary(const Comparison& c) {
  std::vector<std::pair<double, std::string>> order;
  for (const ContenderResult& contender : c.contenders)
    order.emplace_back(median_of(contender, [](const Repetition& r) { return r.rel_mse; }), contender.name);
  std::stable_sort(order.begin(), order.end());
  TextBlock block{.title = "In short", .text = {}, .points = c.notes};
  block.text = fmt::format("{} is closest to the reference: relMSE {}.", order.front().second,
                           short_number(order.front().first));
  for (size_t i = 1; i < order.size() && order.front().first > 0; ++i) {
    const double ratio = order[i].first / order.front().first;
    block.text += i == 1 ? " " : "; ";
    block.text += fmt::format("{}{} has {} times as much", i == 1 ? "With the same measure " : "", order[i].second,
                              short_number(ratio));
  }
  if (order.size() > 1) block.text += ".";
  return block;
}

DetailsBlock how_it_was_made(const Comparison& c, const std::vector<std::pair<std::string, std::string>>& machine) {
  DetailsBlock block{.title = "How it was made", .text = {}, .pairs = machine, .parts = {}};
  const Reference& r = c.reference;
  std::string common;
  for (const auto& [name, value] : c.options.common.flags)
    common += fmt::format("{}{} = {}", common.empty() ? "" : ", ", name, value);
  block.pairs.emplace_back("Threads", std::to_string(c.threads));
  block.pairs.emplace_back(
      "Scene", fmt::format("{}, {} triangles, hash {:016x}", c.options.scene_name, c.triangles, c.scene_hash));
  block.pairs.emplace_back(
      "Comparison",
      fmt::format("{}; median of {} repetitions with seeds of their own; the contenders take turns frame by frame",
                  budget_text(c), c.options.repetitions));
  block.pairs.emplace_back(
      "Reference",
      r.spp == 0
          ? c.options.reference_file.string()
          : fmt::format("{} samples a pixel, {}; expected MSE {} and relMSE {}, from two halves with independent seeds",
                        r.spp, r.cached ? "from the cache" : fmt::format("rendered in {:.1f} s", r.render_s),
                        short_number(r.mse), short_number(r.rel_mse)));
  block.pairs.emplace_back("Common settings", common.empty() ? "the defaults" : common);
  for (const ContenderResult& contender : c.contenders) {
    std::string what = contender.is_picture ? contender.settings : "";
    for (const auto& [name, value] : contender.differences)
      what += fmt::format("{}{} = {}", what.empty() ? "" : ", ", name, value);
    block.pairs.emplace_back(contender.name, what.empty() ? "nothing but the common settings" : what);
    if (!contender.is_picture) block.parts.emplace_back("All settings of " + contender.name, contender.settings);
  }
  Settings reference_settings = c.reference_settings;
  if (r.spp > 0)
    block.parts.emplace_back("All settings of the reference", settings_to_json(describe(reference_settings)));
  return block;
}

}  // namespace

std::string short_number(double x) { return std::isfinite(x) ? fmt::format("{:.3g}", x) : "–"; }

TableBlock comparison_table(const Comparison& c) {
  TableBlock block{
      .title = "Figures",
      .text = fmt::format("Medians of {} repetitions{}; below them {}. The best value of a column is marked.",
                          c.options.repetitions, is_animation(c) ? " and means over the frames" : "",
                          c.options.repetitions > 1
                              ? "the interval of the median (95 %, or the whole range where there are fewer than six)"
                              : "nothing, with one repetition"),
      .row_title = "contender",
      .columns = table_columns(c),
      .rows = {}};
  for (size_t i = 0; i < c.contenders.size(); ++i)
    block.rows.push_back(contender_row(c, c.contenders[i], static_cast<int>(i)));
  block.rows.push_back(reference_row(c));
  return block;
}

ChartBlock comparison_curves(const Comparison& c) {
  const auto mse = [](const ErrorPoint& p) { return p.mse; };
  const auto rel_mse = [](const ErrorPoint& p) { return p.rel_mse; };
  const auto frames = [](const ErrorPoint& p) { return static_cast<double>(p.frames); };
  const auto samples = [](const ErrorPoint& p) { return p.samples; };
  const auto time_ms = [](const ErrorPoint& p) { return 1000 * p.time_s; };
  const double noise = c.reference.mse;
  const double rel_noise = c.reference.rel_mse;
  ChartBlock block{.title = is_animation(c) ? "Error along the animation" : "Convergence",
                   .text = "Medians over the repetitions; bands are their intervals.",
                   .charts = {}};
  if (is_animation(c)) {
    block.charts.push_back(make_chart(c, "relMSE", "frame", "relMSE", frames, rel_mse, rel_noise));
    block.charts.push_back(make_chart(c, "MSE", "frame", "MSE", frames, mse, noise));
    return block;
  }
  block.charts.push_back(make_chart(c, "relMSE by time", "time, ms", "relMSE", time_ms, rel_mse, rel_noise));
  block.charts.push_back(make_chart(c, "relMSE by samples", "samples a pixel", "relMSE", samples, rel_mse, rel_noise));
  block.charts.push_back(make_chart(c, "MSE by time", "time, ms", "MSE", time_ms, mse, noise));
  block.charts.push_back(make_chart(c, "MSE by samples", "samples a pixel", "MSE", samples, mse, noise));
  return block;
}

BarBlock comparison_frame_times(const Comparison& c) {
  BarBlock block{.title = "Time of a frame by pass", .text = "Medians over the repetitions.", .unit = "ms", .bars = {}};
  for (const ContenderResult& contender : c.contenders) {
    if (contender.is_picture) continue;
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

ViewerBlock comparison_pictures(const Comparison& c) {
  const Image& reference = c.reference.image;
  const OutputSettings display = resolve(c.options.common).output;
  const size_t value_bytes = reference.pixels.size() * 6 * (c.contenders.size() + 1);
  const PictureOptions options{display.tone_map, display.exposure, value_bytes <= kMostValueBytes};
  ViewerBlock block{.title = "Pictures",
                    .text = is_animation(c) ? "The last frame of the first repetition." : "Of the first repetition.",
                    .layers = picture_layer_kinds(),
                    .sets = {}};
  std::vector<MeasuredImage> images;
  for (size_t i = 0; i < c.contenders.size(); ++i) {
    const ContenderResult& contender = c.contenders[i];
    const Repetition& first = contender.repetitions.front();
    const double rel_mse = first.curve.empty() ? first.rel_mse : first.curve.back().rel_mse;
    images.push_back(
        {contender.name, static_cast<int>(i), &contender.image, fmt::format("relMSE {}", short_number(rel_mse))});
  }
  block.sets.push_back(measured_set("picture", reference, images, options));
  return block;
}

Page comparison_page(const Comparison& c, const std::vector<std::pair<std::string, std::string>>& machine) {
  Page page;
  page.title = fmt::format("{}: {}", c.options.scene_name, join_names(c.contenders));
  page.subtitle = fmt::format("{}×{} pixels, {}{}", c.reference.image.width, c.reference.image.height, budget_text(c),
                              is_animation(c) ? fmt::format(", {} frames", c.options.times_s.size()) : "");
  page.blocks = {summary(c), comparison_pictures(c), comparison_table(c)};
  const bool has_times =
      std::any_of(c.contenders.begin(), c.contenders.end(), [](const ContenderResult& r) { return !r.is_picture; });
  if (has_times) {
    page.blocks.emplace_back(comparison_curves(c));
    page.blocks.emplace_back(comparison_frame_times(c));
  }
  page.blocks.emplace_back(how_it_was_made(c, machine));
  return page;
}

}  // namespace relume
