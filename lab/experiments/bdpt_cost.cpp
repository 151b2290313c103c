// [Sun20 §5.2]: compares rays per pixel, time and memory of bidirectional and unidirectional path tracing.
#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/regions.h"
#include "techniques/transport/bdpt/path_vertex.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Sun20 §5.2.1]";
constexpr int kSide = 128;

/// Rays per sample by [Sun20 §5.2.1], which counts each visibility test twice.
int paper_rays(int bounces) { return bounces * bounces + 3 * bounces; }
/// Rays per sample of paths without early termination, with each test counted once.
int exact_rays(int bounces) { return 2 * bounces + 1 + bounces * (bounces + 3) / 2; }

struct Case {
  std::string scene;
  int bounces = 0;
  double path_rays = 0;  ///< per sample
  double bdpt_rays = 0;
  double all_rays = 0;  ///< rays of bdpt without Russian roulette
  Ratio time;           ///< frame time of bdpt over path tracing
};

double rays_of(const Comparison& c, std::string_view name) {
  const double pixels = static_cast<double>(c.reference.image.pixels.size());
  return median_of(contender_named(c, name),
                   [](const Repetition& r) { return static_cast<double>(r.rays) / r.samples; }) /
         pixels;
}

/// Time ratio with one value per repetition, in which both took turns.
Ratio time_of(const Comparison& c) {
  const std::vector<double> path = values_of(contender_named(c, "path"), frame_ms);
  const std::vector<double> bdpt = values_of(contender_named(c, "bdpt"), frame_ms);
  std::vector<double> quotients;
  for (size_t i = 0; i < path.size(); ++i) quotients.push_back(bdpt[i] / path[i]);
  return geometric_mean(quotients);
}

Case measure(const ExperimentContext& context, ExperimentScene scene, int bounces) {
  scene.settings.path.max_bounces = bounces;
  StudyOptions options{.techniques =
                           "path=estimator:path,bdpt=estimator:bdpt,all=estimator:bdpt,"
                           "bdpt.connection-roulette:0,path.russian-roulette:false",
                       .spp = context.choose(8, 4),
                       .repetitions = 5,
                       .reference_spp = 2,  // errors are not evaluated
                       .timed = true};
  use_square(context, kSide, options);
  const Comparison c = study(context, scene, options);
  return {scene.name, bounces, rays_of(c, "path"), rays_of(c, "bdpt"), rays_of(c, "all"), time_of(c)};
}

double bound_of(const Case& c) { return 0.5 * c.bounces + 1.5; }

TableBlock table(const std::vector<Case>& cases) {
  TableBlock block{"Rays per sample, and time",
                   "D bounces. Most paths leave the open scenes earlier.",
                   "scene, D",
                   {{"path tracing", "Rays, with Russian roulette."},
                    {"bdpt", "Rays, with Russian roulette on paths and connections."},
                    {"bdpt, all", "Rays without any roulette."},
                    {"at most", "2D + 1 + D(D + 3) / 2: no path ends early, each test is counted once."},
                    {"paper", "D² + 3D."},
                    {"time, bdpt over path"},
                    {"0.5 D + 1.5", "The paper's ratio."}},
                   {}};
  const auto rays = [](double x) { return TableCell{fmt::format("{:.2f}", x), x}; };
  for (const Case& c : cases) {
    block.rows.push_back({fmt::format("{}, {}", c.scene, c.bounces),
                          kNeutralColor,
                          {rays(c.path_rays),
                           rays(c.bdpt_rays),
                           rays(c.all_rays),
                           rays(exact_rays(c.bounces)),
                           rays(paper_rays(c.bounces)),
                           {share_text(c.time), c.time.value},
                           rays(bound_of(c))}});
  }
  return block;
}

ChartBlock charts(const std::vector<Case>& cases) {
  ChartBlock block{"Frame time over that of path tracing", "Dashed: 0.5 D + 1.5.", {}};
  Chart chart{.label = "ratio", .x_label = "bounces", .y_label = "bdpt over path", .curves = {}};
  Curve bound{.name = "paper", .color = kNeutralColor, .dashed = true, .points = {}};
  for (const Case& c : cases) {
    if (chart.curves.empty() || chart.curves.back().name != c.scene)
      chart.curves.push_back({c.scene, static_cast<int>(chart.curves.size()), false, {}});
    chart.curves.back().points.push_back({static_cast<double>(c.bounces), c.time.value});
    if (chart.curves.size() == 1) bound.points.push_back({static_cast<double>(c.bounces), bound_of(c)});
  }
  chart.curves.push_back(std::move(bound));
  block.charts.push_back(std::move(chart));
  return block;
}

/// For each number of bounces, the scene with the most rays per sample, relative to `bound`.
std::string most_rays_text(const std::vector<Case>& cases, int (*bound)(int bounces)) {
  std::map<int, const Case*> worst;
  for (const Case& c : cases) {
    const Case*& of_bounces = worst[c.bounces];
    if (!of_bounces || c.all_rays > of_bounces->all_rays) of_bounces = &c;
  }
  std::string text = "most:";
  for (const auto& [bounces, c] : worst) {
    text += fmt::format("{} D = {}: {:.1f} of {} in {}", text.back() == ':' ? "" : ",", bounces, c->all_rays,
                        bound(bounces), c->scene);
  }
  return text;
}

Claim claim_below_paper(std::string id, std::string claim, const std::vector<Case>& cases) {
  const bool below =
      std::all_of(cases.begin(), cases.end(), [](const Case& c) { return c.all_rays < paper_rays(c.bounces); });
  return judged(std::move(id), kPaper, std::move(claim), most_rays_text(cases, paper_rays),
                "below D² + 3D in every scene", below);
}

void claim_rays(const std::vector<Case>& cases, std::vector<Claim>& claims) {
  std::vector<Case> one_bounce;
  std::vector<Case> more_bounces;
  for (const Case& c : cases) (c.bounces == 1 ? one_bounce : more_bounces).push_back(c);
  claims.push_back(claim_below_paper("rays", "A sample takes D² + 3D rays (relume: fewer, with two or more bounces).",
                                     more_bounces));
  claims.push_back(
      claim_below_paper("rays-one-bounce", "A sample with one bounce takes D² + 3D rays, too.", one_bounce));
  const bool below_exact =
      std::all_of(cases.begin(), cases.end(), [](const Case& c) { return c.all_rays <= exact_rays(c.bounces); });
  claims.push_back(judged("rays-exact", kPaper,
                          "With each test counted once, a sample takes at most 2D + 1 + D(D + 3) / 2 rays.",
                          most_rays_text(cases, exact_rays), "not exceeded in any scene", below_exact));
}

Claim claim_time(const std::vector<Case>& cases) {
  std::map<int, const Case*> nearest;  // keyed by the number of bounces
  std::vector<const char*> verdicts;
  for (const Case& c : cases) {
    const Case*& worst = nearest[c.bounces];
    if (!worst || c.time.value > worst->time.value) worst = &c;
    verdicts.push_back(verdict_of(c.time.interval, 0, bound_of(c)));
  }
  std::string measured;
  for (const auto& [bounces, c] : nearest) {
    measured += fmt::format("{}D = {}: {} of {:.1f} in {}", measured.empty() ? "" : ", ", bounces, share_text(c->time),
                            bound_of(*c), c->scene);
  }
  return with_verdict("time", kPaper, "A frame takes 0.5 D + 1.5 times as long as with path tracing.",
                      "nearest to it: " + measured, "at most that in every scene, by the interval",
                      verdict_of_all(verdicts));
}

Claim claim_vertex() {
  return judged("vertex", "[Sun20 §5.2.2]", "A path vertex takes 82 bytes (its 21 words are 84).",
                fmt::format("{} bytes", sizeof(PathVertex)), "at most 96 bytes", sizeof(PathVertex) <= 96);
}

ExperimentResult run_bdpt_cost(const ExperimentContext& context) {
  const std::vector<int> bounces = context.quick ? std::vector<int>{1, 4} : std::vector<int>{1, 2, 3, 4, 6, 8};
  std::vector<Case> cases;
  const auto add = [&](const ExperimentScene& scene) {
    for (const int d : bounces) cases.push_back(measure(context, scene, d));
  };
  for (const char* name :
       {"cornell-closed", "cornell-spheres", "cornell-mirror", "cornell-water", "cornell-glass", "door"}) {
    add(built_in(name, bounces.front()));
  }
  if (const std::optional<ExperimentScene> hall = sponza(context)) add(*hall);
  ExperimentResult result;
  claim_rays(cases, result.claims);
  result.claims.push_back(claim_time(cases));
  result.claims.push_back(claim_vertex());
  result.blocks.emplace_back(table(cases));
  result.blocks.emplace_back(charts(cases));
  result.setup = {{"Size", square_text(context, kSide)},
                  {"Time", fmt::format("5 × {} frames, alternately", context.choose(8, 4))},
                  {"Settings", "the defaults of each; \"all\" has neither kind of roulette"}};
  return result;
}

}  // namespace

Experiment bdpt_cost_experiment() {
  return {"bdpt-cost", kPaper, "rays, time and memory of bidirectional path tracing", run_bdpt_cost};
}

}  // namespace relume
