// A page of results as data, and its self-contained HTML file: images, curves, tables, claims. The file needs no
// network and no other file.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace relume {

/// Colours are indices into the page's palette of nine; a contender has the same colour throughout.
inline constexpr int kNeutralColor = -1;

/// A paragraph and a list of points.
struct TextBlock {
  std::string title;
  std::string text;
  std::vector<std::string> points = {};
};

enum class Better { none, lower, higher };

struct TableColumn {
  std::string title;
  std::string help = {};
  Better better = Better::none;  ///< the best value of the column is marked
};

struct TableCell {
  std::string text;
  std::optional<double> value = {};  ///< sort key, also for the best value
  std::string note = {};             ///< small text below
};

struct TableRow {
  std::string name;
  int color = kNeutralColor;
  std::vector<TableCell> cells;
  bool competes = true;  ///< whether it can be marked as best
};

struct TableBlock {
  std::string title;
  std::string text;
  std::string row_title;
  std::vector<TableColumn> columns;  ///< excludes the column of row names
  std::vector<TableRow> rows;
};

/// Low and high bound a band around the curve; not finite: no band.
struct CurvePoint {
  double x = 0;
  double y = 0;
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

struct Curve {
  std::string name;
  int color = kNeutralColor;
  bool dashed = false;
  std::vector<CurvePoint> points;
};

struct Chart {
  std::string label;  ///< label of its selector
  std::string x_label;
  std::string y_label;
  bool log_x = false;
  bool log_y = false;
  std::vector<Curve> curves;
};

/// Charts, displayed one at a time.
struct ChartBlock {
  std::string title;
  std::string text;
  std::vector<Chart> charts;
};

/// A bar of stacked, named parts.
struct Bar {
  std::string name;
  std::vector<std::pair<std::string, double>> parts;
};

struct BarBlock {
  std::string title;
  std::string text;
  std::string unit;
  std::vector<Bar> bars;
};

/// A paper's claim beside the measurement.
struct Claim {
  std::string id;     ///< kebab-case
  std::string paper;  ///< key and location: "[Schalk18 §4.3]"
  std::string claim;
  std::string measured;
  std::string threshold;  ///< condition for "holds"
  std::string verdict;    ///< one of the kVerdict constants
};
inline constexpr const char* kVerdictHolds = "holds";
inline constexpr const char* kVerdictFails = "does not hold";
inline constexpr const char* kVerdictUndecided = "undecided";  ///< the threshold is within the measured interval
inline constexpr const char* kVerdictOpen = "not measured";

struct ClaimBlock {
  std::string title;
  std::string text;
  std::vector<Claim> claims;
};

/// Meaning of a map's colours.
struct LayerKind {
  std::string label;
  std::string ramp = {};  ///< "magma", "diverging"; empty: none
  std::string low = {};
  std::string high = {};
};

/// PNG bytes in base64.
struct ImageLayer {
  std::string label;
  std::string png;
};

struct PageImage {
  std::string name;
  int color = kNeutralColor;
  std::string note;  ///< text beside the name
  std::vector<ImageLayer> layers;
  std::vector<std::string> values;  ///< two PNGs with the high and low bytes of binary16; empty: omitted
};

/// A square, pixels.
struct Crop {
  int x = 0;
  int y = 0;
  int size = 0;
};

/// Images of equal size that are viewed together.
struct ImageSet {
  std::string label;
  int width = 0;
  int height = 0;
  int reference = 0;  ///< index of the reference image
  std::vector<PageImage> images;
  std::vector<Crop> crops;
};

struct ViewerBlock {
  std::string title;
  std::string text;
  std::vector<LayerKind> layers;  ///< the first is the only one of images without maps
  std::vector<ImageSet> sets;
};

struct DetailsBlock {
  std::string title;
  std::string text;
  std::vector<std::pair<std::string, std::string>> pairs;
  std::vector<std::pair<std::string, std::string>> parts;  ///< title and preformatted text, collapsed
};

struct Link {
  std::string href;
  std::string text;
  std::string note = {};
};

struct LinkBlock {
  std::string title;
  std::string text;
  std::vector<Link> links;
};

using Block =
    std::variant<TextBlock, TableBlock, ChartBlock, BarBlock, ClaimBlock, ViewerBlock, DetailsBlock, LinkBlock>;

struct Page {
  std::string title;
  std::string subtitle;
  std::vector<Block> blocks;
};

/// HTML of the page. Equal pages give equal bytes.
std::string to_html(const Page& page);

}  // namespace relume
