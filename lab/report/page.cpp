#include "report/page.h"

#include <cmath>
#include <string_view>

#include <nlohmann/json.hpp>

#include "report/assets.h"

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

/// Non-finite values become null.
Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

template <typename T, typename F>
Json list(const std::vector<T>& values, F&& to_json) {
  Json json = Json::array();
  for (const T& value : values) json.push_back(to_json(value));
  return json;
}

Json pairs(const std::vector<std::pair<std::string, std::string>>& values) {
  return list(values, [](const auto& pair) { return Json::array({pair.first, pair.second}); });
}

Json block(const char* kind, const std::string& title, const std::string& text) {
  return {{"kind", kind}, {"title", title}, {"text", text}};
}

Json to_json(const TextBlock& b) {
  Json json = block("text", b.title, b.text);
  json["points"] = b.points;
  return json;
}

Json to_json(const TableCell& cell) {
  Json json = {{"text", cell.text}};
  if (cell.value && std::isfinite(*cell.value)) json["value"] = *cell.value;
  if (!cell.note.empty()) json["note"] = cell.note;
  return json;
}

const char* name_of(Better better) {
  return better == Better::none ? "none" : better == Better::lower ? "lower" : "higher";
}

Json to_json(const TableBlock& b) {
  Json json = block("table", b.title, b.text);
  json["row_title"] = b.row_title;
  json["columns"] = list(b.columns, [](const TableColumn& column) -> Json {
    return {{"title", column.title}, {"help", column.help}, {"better", name_of(column.better)}};
  });
  json["rows"] = list(b.rows, [](const TableRow& row) -> Json {
    return {{"name", row.name},
            {"color", row.color},
            {"plain", !row.competes},
            {"cells", list(row.cells, [](const TableCell& cell) { return to_json(cell); })}};
  });
  return json;
}

Json to_json(const CurvePoint& p) {
  Json json = Json::array({number(p.x), number(p.y)});
  if (std::isfinite(p.low) && std::isfinite(p.high)) json.insert(json.end(), {p.low, p.high});
  return json;
}

Json to_json(const ChartBlock& b) {
  Json json = block("chart", b.title, b.text);
  json["charts"] = list(b.charts, [](const Chart& chart) -> Json {
    return {{"label", chart.label},
            {"x_label", chart.x_label},
            {"y_label", chart.y_label},
            {"log_x", chart.log_x},
            {"log_y", chart.log_y},
            {"curves", list(chart.curves, [](const Curve& curve) -> Json {
               return {{"name", curve.name},
                       {"color", curve.color},
                       {"dashed", curve.dashed},
                       {"points", list(curve.points, [](const CurvePoint& p) { return to_json(p); })}};
             })}};
  });
  return json;
}

Json to_json(const BarBlock& b) {
  Json json = block("bars", b.title, b.text);
  json["unit"] = b.unit;
  json["bars"] = list(b.bars, [](const Bar& bar) -> Json {
    return {{"name", bar.name}, {"parts", list(bar.parts, [](const auto& part) {
                                   return Json::array({part.first, number(part.second)});
                                 })}};
  });
  return json;
}

Json to_json(const ClaimBlock& b) {
  Json json = block("claims", b.title, b.text);
  json["claims"] = list(b.claims, [](const Claim& c) -> Json {
    return {{"id", c.id},
            {"paper", c.paper},
            {"claim", c.claim},
            {"measured", c.measured},
            {"threshold", c.threshold},
            {"verdict", c.verdict}};
  });
  return json;
}

Json to_json(const PageImage& page_image) {
  Json json = {{"name", page_image.name}, {"color", page_image.color}, {"note", page_image.note}};
  json["layers"] = list(page_image.layers, [](const ImageLayer& layer) -> Json {
    return {{"label", layer.label}, {"png", layer.png}};
  });
  if (!page_image.values.empty()) json["values"] = page_image.values;
  return json;
}

Json to_json(const ViewerBlock& b) {
  Json json = block("viewer", b.title, b.text);
  json["layers"] = list(b.layers, [](const LayerKind& layer) -> Json {
    return {{"label", layer.label}, {"ramp", layer.ramp}, {"low", layer.low}, {"high", layer.high}};
  });
  json["views"] = list(b.sets, [](const ImageSet& set) -> Json {
    return {{"label", set.label},
            {"width", set.width},
            {"height", set.height},
            {"reference", set.reference},
            {"images", list(set.images, [](const PageImage& page_image) { return to_json(page_image); })},
            {"crops", list(set.crops, [](const Crop& c) {
               return Json::array({c.x, c.y, c.size});
             })}};
  });
  return json;
}

Json to_json(const DetailsBlock& b) {
  Json json = block("details", b.title, b.text);
  json["pairs"] = pairs(b.pairs);
  json["parts"] = list(b.parts, [](const auto& part) -> Json {
    return {{"title", part.first}, {"text", part.second}};
  });
  return json;
}

Json to_json(const LinkBlock& b) {
  Json json = block("links", b.title, b.text);
  json["links"] = list(b.links, [](const Link& link) -> Json {
    return {{"href", link.href}, {"text", link.text}, {"note", link.note}};
  });
  return json;
}

/// JSON for a script element, escaped so that it cannot end the element.
std::string embed(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size() + 64);
  for (char c : text) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

std::string escape(std::string_view text) {
  std::string result;
  for (char c : text) {
    switch (c) {
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '&': result += "&amp;"; break;
      default: result += c;
    }
  }
  return result;
}

}  // namespace

std::string to_html(const Page& page) {
  Json data = {{"title", page.title}, {"subtitle", page.subtitle}};
  data["blocks"] = list(
      page.blocks, [](const Block& b) { return std::visit([](const auto& content) { return to_json(content); }, b); });
  std::string html;
  std::string_view rest = page_assets::kPage;
  while (!rest.empty()) {  // @NAME@ is a placeholder
    const size_t begin = rest.find('@');
    html += rest.substr(0, begin);
    if (begin == std::string_view::npos) break;
    const size_t end = rest.find('@', begin + 1);
    const std::string_view name = rest.substr(begin + 1, end - begin - 1);
    if (name == "TITLE") html += escape(page.title);
    if (name == "STYLE") html += page_assets::kStyle;
    if (name == "DATA") html += embed(data);
    if (name == "SCRIPT") html += page_assets::kScript;
    rest.remove_prefix(end + 1);
  }
  return html;
}

}  // namespace relume
