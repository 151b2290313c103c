// The table of a comparison.
#include <utility>

#include <fmt/format.h>

#include "compare/comparison_page.h"
#include "compare/ranking.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

/// A column of medians over the repetitions.
struct MedianColumn {
  TableColumn column;
  Figure figure;
};

std::vector<MedianColumn> error_columns(const Comparison& c) {
  const std::string of_frame = is_animation(c.options) ? " Of the last frame." : "";
  return {
      {{"MSE", "Mean squared error of linear radiance against the reference.", Better::lower}, &Repetition::mse},
      {{"relMSE", "Squared error over the squared reference + 0.01, so that dark regions count as much as bright ones.",
        Better::lower},
       &Repetition::rel_mse},
      {{"MAPE", "Absolute error over the reference + 0.01.", Better::lower}, &Repetition::mape},
      {{"FLIP",
        "Difference that a viewer sees when flipping between image and reference, from 0 to 1 (Andersson 2020)." +
            of_frame,
        Better::lower},
       &Repetition::flip},
  };
}

std::vector<TableColumn> split_columns(const Comparison& c) {
  const std::string of_frame = is_animation(c.options) ? " Of the last frame, unlike the MSE." : "";
  return {
      {"bias²",
       "Part of the MSE common to all repetitions: the error that remains in the mean of infinitely many such images. "
       "Images with more samples may have less of it. The noise of the reference is subtracted. Below: two standard "
       "errors, from the spread of at least three repetitions; a value within them is not significantly different from "
       "0." +
           of_frame},
      {"variance", "Part of the MSE that differs between repetitions." + of_frame},
  };
}

std::vector<MedianColumn> cost_columns(const Comparison& c) {
  std::vector<MedianColumn> columns;
  if (is_animation(c.options)) {
    columns.push_back({{"temporal error",
                        "Flicker: squared change of the relative error from frame to frame on each surface. Motion and "
                        "changes of the light do not count; noise of the references does.",
                        Better::lower},
                       &Repetition::temporal_error});
  }
  columns.push_back({{"samples", fmt::format("Mean number of paths per pixel{}. Camera rays that caches and denoisers "
                                             "trace at the edges of lamps count only in rays and time.",
                                             is_animation(c.options) ? ", all frames together" : "")},
                     &Repetition::samples});
  columns.push_back({{"time, s", "Time of the frames, without loading, building and measuring."}, &Repetition::time_s});
  columns.push_back({{"ms per frame", "Time over frames.", Better::lower}, frame_ms});
  return columns;
}

std::vector<TableColumn> table_columns(const Comparison& c) {
  std::vector<TableColumn> columns;
  const auto add_medians = [&](std::vector<MedianColumn> medians, bool with_images) {
    for (MedianColumn& entry : medians) {
      if (leaders(c, entry.figure, with_images).size() != 1) entry.column.better = Better::none;
      columns.push_back(std::move(entry.column));
    }
  };
  add_medians(error_columns(c), true);
  for (TableColumn& column : split_columns(c)) columns.push_back(std::move(column));
  add_medians(cost_columns(c), false);
  columns.push_back({"rays per pixel", "Path and shadow rays, and camera rays at the edges of lamps."});
  return columns;
}

/// Median with its interval below.
TableCell median_cell(const ContenderResult& contender, const Figure& figure) {
  const std::vector<double> values = values_of(contender, figure);
  const Interval interval = median_interval(values);
  TableCell cell{.text = short_number(median(values)), .value = median(values)};
  if (interval.confidence > 0)
    cell.note = fmt::format("{} – {}", short_number(interval.low), short_number(interval.high));
  return cell;
}

TableCell bias_cell(const ErrorSplit& split) {
  TableCell cell{.text = short_number(split.bias2), .value = split.bias2, .note = "± not known"};
  if (!split.bias2_error) return cell;
  const double noise = 2 * *split.bias2_error;
  cell.note = fmt::format("± {}", short_number(noise));
  if (split.bias2 > noise) return cell;
  cell.note = fmt::format("{} {}", cell.text, cell.note);
  cell.text = "≈ 0";
  return cell;
}

double rays_per_pixel(const Comparison& c, const ContenderResult& contender) {
  const double pixels = double(c.reference.image.width) * c.reference.image.height;
  return median_of(contender, &Repetition::rays) / pixels;
}

TableRow contender_row(const Comparison& c, size_t index, size_t columns) {
  const ContenderResult& contender = c.contenders[index];
  TableRow row{.name = contender.name, .color = static_cast<int>(index), .cells = {}, .competes = is_ranked(contender)};
  for (const MedianColumn& column : error_columns(c)) row.cells.push_back(median_cell(contender, column.figure));
  if (contender.split) {
    row.cells.push_back(bias_cell(*contender.split));
    row.cells.push_back({short_number(contender.split->variance), contender.split->variance});
  }
  if (contender.is_image) {
    row.cells.resize(columns, TableCell{"–"});
    return row;
  }
  if (!contender.split) row.cells.resize(row.cells.size() + 2, {.text = "–", .note = "not known"});
  for (const MedianColumn& column : cost_columns(c)) row.cells.push_back(median_cell(contender, column.figure));
  const double rays = rays_per_pixel(c, contender);
  row.cells.push_back({.text = short_number(rays), .value = rays});
  return row;
}

TableRow reference_row(const Comparison& c, size_t columns) {
  TableRow row{.name = "reference", .cells = {}, .competes = false};
  row.cells.assign(columns, TableCell{"–"});
  if (c.reference.spp == 0) return row;
  const auto noise = [](double value) {
    return TableCell{.text = short_number(value), .value = value, .note = "its own noise"};
  };
  row.cells[0] = noise(c.reference_noise.mse);
  row.cells[1] = noise(c.reference_noise.rel_mse);
  size_t next = error_columns(c).size() + split_columns(c).size();
  if (is_animation(c.options)) row.cells[next++] = noise(c.reference_noise.temporal_error);
  row.cells[next] = {.text = short_number(c.reference.spp), .value = c.reference.spp};
  return row;
}

/// Text above the table.
std::string explanation(const Comparison& c) {
  if (c.threads == 0) return "Values of single images. The best value of a column is marked.";
  const int repetitions = c.options.repetitions;
  std::string text = fmt::format("Medians of {} repetitions{}; ", repetitions,
                                 is_animation(c.options) ? " and means over the frames" : "");
  text += repetitions > 1 ? "below them the interval of the median (95 %, or the whole range with fewer than six). "
                          : "without intervals, with one repetition. ";
  text += repetitions > 2 ? "The best value of a column is marked if its interval overlaps no other."
                          : "With fewer than three repetitions no best value is marked, because it may be chance.";
  return text;
}

}  // namespace

TableBlock comparison_table(const Comparison& c) {
  TableBlock block{
      .title = "Figures", .text = explanation(c), .row_title = "contender", .columns = table_columns(c), .rows = {}};
  const size_t columns = block.columns.size();
  for (size_t i = 0; i < c.contenders.size(); ++i) block.rows.push_back(contender_row(c, i, columns));
  block.rows.push_back(reference_row(c, columns));
  return block;
}

}  // namespace relume
