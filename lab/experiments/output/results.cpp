#include "experiments/output/results.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "files/json_parse.h"
#include "relume/error.h"

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kQuickNote =
    "A quick run: small images, few settings, much noise. It shows that everything runs; its verdicts mean little.";

std::string count_text(const std::vector<Claim>& claims) {
  const auto count = [&](std::string_view verdict) {
    return std::count_if(claims.begin(), claims.end(), [&](const Claim& c) { return c.verdict == verdict; });
  };
  std::string text = fmt::format("{} of {} claims hold", count(kVerdictHolds), claims.size());
  if (const auto undecided = count(kVerdictUndecided); undecided > 0) text += fmt::format(", {} undecided", undecided);
  if (const auto open = count(kVerdictOpen); open > 0) text += fmt::format(", {} not measured", open);
  return text;
}

std::string duration_text(double seconds) {
  return seconds < 100 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60);
}

Json claim_json(const Claim& c) {
  return {{"id", c.id},
          {"paper", c.paper},
          {"claim", c.claim},
          {"measured", c.measured},
          {"threshold", c.threshold},
          {"verdict", c.verdict}};
}

void add_curves(const ChartBlock& block, Json& curves) {
  for (const Chart& chart : block.charts) {
    for (const Curve& curve : chart.curves) {
      Json points = Json::array();
      for (const CurvePoint& p : curve.points) points.push_back({p.x, p.y});
      curves.push_back({{"title", block.title},
                        {"chart", chart.label},
                        {"curve", curve.name},
                        {"x", chart.x_label},
                        {"y", chart.y_label},
                        {"points", std::move(points)}});
    }
  }
}

std::string cell_with_note(const TableCell& cell) {
  return cell.note.empty() ? cell.text : fmt::format("{} ({})", cell.text, cell.note);
}

Json table_json(const TableBlock& block) {
  Json columns = Json::array({block.row_title});
  for (const TableColumn& column : block.columns) columns.push_back(column.title);
  Json rows = Json::array();
  for (const TableRow& row : block.rows) {
    Json cells = Json::array({row.name});
    for (const TableCell& cell : row.cells) cells.push_back(cell_with_note(cell));
    rows.push_back(std::move(cells));
  }
  return {{"title", block.title}, {"columns", std::move(columns)}, {"rows", std::move(rows)}};
}

Json bars_json(const BarBlock& block) {
  Json rows = Json::array();
  for (const Bar& bar : block.bars) {
    for (const auto& [part, value] : bar.parts) rows.push_back({bar.name, part, fmt::format("{:.4g}", value)});
  }
  return {{"title", block.title}, {"columns", {"", "part", block.unit}}, {"rows", std::move(rows)}};
}

/// The machine. If it names no device, the value of --device is added, except for the host.
std::vector<std::pair<std::string, std::string>> machine_of(const ExperimentRun& run) {
  auto machine = run.machine;
  const bool has_device =
      std::any_of(machine.begin(), machine.end(), [](const auto& entry) { return entry.first == "Device"; });
  if (!has_device && run.device != "cpu") machine.emplace_back("Device", run.device);
  return machine;
}

std::string machine_text(const ExperimentRun& run) {
  std::string text;
  for (const auto& [name, value] : machine_of(run)) text += fmt::format("; {}: {}", name, value);
  return text;
}

/// Text of a table cell: escapes bars, which would end it.
std::string cell_text(std::string_view text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|' || c == '\\') cell += '\\';
    cell += c == '\n' ? ' ' : c;
  }
  return cell;
}

}  // namespace

std::string to_json(const Experiment& experiment, const ExperimentResult& result, const ExperimentRun& run) {
  Json json = {{"name", experiment.name}, {"paper", experiment.paper}, {"summary", experiment.summary},
               {"quick", run.quick},      {"seconds", run.seconds},    {"scenes", run.scenes},
               {"program", run.program},  {"device", run.device},      {"machine", Json::object()},
               {"setup", Json::object()}, {"claims", Json::array()},   {"tables", Json::array()},
               {"curves", Json::array()}};
  for (const auto& [name, value] : run.machine) json["machine"][name] = value;
  for (const auto& [name, value] : result.setup) json["setup"][name] = value;
  for (const Claim& c : result.claims) json["claims"].push_back(claim_json(c));
  for (const Block& block : result.blocks) {
    if (const auto* charts = std::get_if<ChartBlock>(&block)) add_curves(*charts, json["curves"]);
    if (const auto* table = std::get_if<TableBlock>(&block)) json["tables"].push_back(table_json(*table));
    if (const auto* bars = std::get_if<BarBlock>(&block)) json["tables"].push_back(bars_json(*bars));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Page experiment_page(const Experiment& experiment, const ExperimentResult& result, const ExperimentRun& run) {
  Page page{std::string(experiment.name), fmt::format("{}: {}", experiment.paper, experiment.summary), {}};
  TextBlock lead{"Summary", count_text(result.claims) + ".", {}};
  if (run.quick) lead.points.emplace_back(kQuickNote);
  page.blocks.emplace_back(lead);
  page.blocks.emplace_back(ClaimBlock{"Claims", "A claim that does not hold is a result, too.", result.claims});
  for (const Block& block : result.blocks) page.blocks.push_back(block);
  DetailsBlock made{"Method", "", machine_of(run), {}};
  made.pairs.emplace_back("Duration", duration_text(run.seconds));
  made.pairs.insert(made.pairs.end(), result.setup.begin(), result.setup.end());
  page.blocks.emplace_back(made);
  return page;
}

ExperimentSummary read_summary(std::string_view text, const std::string& place) {
  const nlohmann::json json = parse_json(text, place);
  const auto string = [](const nlohmann::json& object, const char* key) { return object.at(key).get<std::string>(); };
  try {
    ExperimentSummary summary{string(json, "name"), string(json, "paper"), string(json, "summary"), {}, {}};
    summary.run.quick = json.at("quick").get<bool>();
    summary.run.seconds = json.at("seconds").get<double>();
    summary.run.scenes = json.value("scenes", true);
    summary.run.program = json.value("program", "");
    summary.run.device = json.value("device", "cpu");
    for (const auto& [name, value] : json.at("machine").items())
      summary.run.machine.emplace_back(name, value.get<std::string>());
    for (const nlohmann::json& c : json.at("claims")) {
      summary.claims.push_back({string(c, "id"), string(c, "paper"), string(c, "claim"), string(c, "measured"),
                                string(c, "threshold"), string(c, "verdict")});
    }
    return summary;
  } catch (const nlohmann::json::exception&) {
    throw Error(place + ": this is not the result of an experiment; move it away or choose another folder");
  }
}

Page index_page(const std::vector<ExperimentSummary>& experiments) {
  Page page{"Experiments", "Claims of papers, and relume's measurements", {}};
  LinkBlock links{"Experiments", "", {}};
  std::vector<Claim> all;
  bool quick = false;
  DetailsBlock made{"Method", "", {}, {}};
  for (const ExperimentSummary& e : experiments) {
    all.insert(all.end(), e.claims.begin(), e.claims.end());
    quick = quick || e.run.quick;
    links.links.push_back(
        {e.name + ".html", e.name, fmt::format("{}: {}; {}", e.paper, e.summary, count_text(e.claims))});
    made.pairs.emplace_back(e.name,
                            (e.run.quick ? "quick run, " : "") + duration_text(e.run.seconds) + machine_text(e.run));
  }
  TextBlock lead{"Summary", count_text(all) + ".", {}};
  if (quick) lead.points.emplace_back(kQuickNote);
  page.blocks = {lead, links};
  for (const ExperimentSummary& e : experiments)
    page.blocks.emplace_back(ClaimBlock{e.name, fmt::format("{}: {}.", e.paper, e.summary), e.claims});
  page.blocks.emplace_back(made);
  return page;
}

std::string index_markdown(const std::vector<ExperimentSummary>& experiments) {
  std::vector<Claim> all;
  std::string text;
  for (const ExperimentSummary& e : experiments) {
    all.insert(all.end(), e.claims.begin(), e.claims.end());
    text += fmt::format("\n## {}\n\n{}: {}. {}: {}.\n", e.name, e.paper, e.summary,
                        e.run.quick ? "A quick run" : "In full", count_text(e.claims));
    text += fmt::format("\nDuration: {}{}.\n", duration_text(e.run.seconds), machine_text(e.run));
    text += "\n| paper | claim | measured | threshold | verdict |\n|---|---|---|---|---|\n";
    for (const Claim& c : e.claims) {
      text += fmt::format("| {} | {} | {} | {} | {} |\n", cell_text(c.paper), cell_text(c.claim), cell_text(c.measured),
                          cell_text(c.threshold), cell_text(c.verdict));
    }
  }
  const bool quick = std::any_of(experiments.begin(), experiments.end(), [](const auto& e) { return e.run.quick; });
  return fmt::format("# Experiments\n\nClaims of papers, and relume's measurements: {}.{}\n{}", count_text(all),
                     quick ? fmt::format(" {}", kQuickNote) : "", text);
}

}  // namespace relume
