#include <fmt/core.h>

#include <algorithm>

#include "bench/study/heights_survey.h"
#include "bench/study/scales_parts.h"
#include "bench/study/scales_pictures.h"
#include "core/base/thread_pool.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

// The rectangle above which photos were taken for training: scenes of all flights know the ground below it.
GroundArea FlownArea(const survey::Survey& survey) {
  GroundArea area{Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()),
                  Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity())};
  for (const survey::Photo& photo : survey.photos) {
    if (photo.is_test) continue;
    const Eigen::Vector2d place = photo.cam_from_enu.Inverse().translation.head<2>();
    area.min_enu = area.min_enu.cwiseMin(place);
    area.max_enu = area.max_enu.cwiseMax(place);
  }
  return area;
}

std::vector<int> RisingHeights(const HeightsPlan& plan) {
  std::vector<int> heights = plan.flights_m;
  heights.insert(heights.end(), plan.views_m.begin(), plan.views_m.end());
  std::sort(heights.begin(), heights.end());
  return heights;
}

// Photos of one flight, or an equal number from all of them.
struct Flown {
  std::string name;
  Variant photos;
};

std::vector<Flown> FlownChoices(const HeightsPlan& plan) {
  std::vector<Flown> choices;
  choices.reserve(plan.flights_m.size() + 1);
  Flown all{.name = "all", .photos = {}};
  all.photos.label = ", from";
  all.photos.every_nth_photo = static_cast<int>(plan.flights_m.size());
  for (const int height_m : plan.flights_m) {
    choices.push_back({.name = fmt::format("{:03d}", height_m), .photos = {}});
    choices.back().photos.label = fmt::format(", from {} m", height_m);
    choices.back().photos.photo_prefixes = {HeightPrefix(height_m)};
    all.photos.label += fmt::format("{} {} m", all.photos.photo_prefixes.empty() ? "" : " and", height_m);
    all.photos.photo_prefixes.push_back(HeightPrefix(height_m));
  }
  choices.push_back(std::move(all));
  return choices;
}

BenchTable HeightTable(const std::vector<MethodResults>& methods, const std::vector<int>& heights) {
  BenchTable table{.name = "heights",
                   .title = "PSNR by height of the rendering",
                   .note = "Full width, one ray per pixel. Pixels that show the area flown over; mean over held-out photos, median over trainings.",
                   .columns = {"method", "photos"},
                   .rows = {}};
  for (const int height_m : heights) table.columns.push_back(fmt::format("{} m", height_m));
  for (const MethodResults& m : methods) {
    std::vector<BenchCell> row = {BenchCell::Text(m.First().failure.empty() ? m.label : m.label + " (" + m.First().failure + ")"),
                                  BenchCell::Number(m.First().training_photos, 0)};
    for (const int height_m : heights) row.push_back(BenchCell::Number(m.Psnr(HeightPrefix(height_m), 1, false), 2, "dB"));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string HeightChart(const std::vector<MethodResults>& methods, const std::vector<int>& heights, const std::string& title) {
  std::vector<page::Curve> curves;
  curves.reserve(methods.size());
  for (const MethodResults& m : methods) {
    page::Curve curve{.name = m.label, .points = {}, .marks = true};
    for (const int height_m : heights) curve.points.emplace_back(height_m, m.Psnr(HeightPrefix(height_m), 1, false));
    curves.push_back(std::move(curve));
  }
  return page::CurveChart(curves, {.title = title, .x_label = "height of the rendering (m)", .y_label = "PSNR (dB)", .log_x = true});
}

// Of one choice of photos: the best method with cones against points.
std::string HeightVerdict(const std::vector<MethodResults>& of_choice, const std::vector<int>& heights) {
  const MethodResults* points = Find(of_choice, {});
  if (points == nullptr) return "";
  const MethodResults* best = nullptr;
  double best_db = -std::numeric_limits<double>::infinity();
  for (const MethodResults& m : of_choice) {
    double sum = 0.0;
    for (const int height_m : heights) sum += m.Psnr(HeightPrefix(height_m), 1, false);
    if (m.method.positions == 0 || !(sum > best_db)) continue;
    best = &m;
    best_db = sum;
  }
  if (best == nullptr) return "";
  std::string text = fmt::format("'{}' against '{}':", best->label, points->label);
  for (const int height_m : heights) {
    const std::string gain = Shown(PsnrDifferenceAt(*best, *points, HeightPrefix(height_m), 1));
    text += fmt::format("{} {} at {} m", height_m == heights.front() ? "" : ",", gain, height_m);
  }
  return text + ".";
}

}  // namespace

void AddHeights(const Study& study, const ScalesOptions& options, StudyBench* bench) {
  HeightsPlan plan;
  plan.views = options.height_views;
  const std::filesystem::path photos = study.folder() / "heights" / "simulated";
  simulate::SimulateOptions simulated = study.settings().simulate;
  simulated.place = options.place;
  base::ThreadPool threads(study.settings().run.UsableThreads());
  const std::filesystem::path held_out = SimulateHeights(simulated, plan, photos, threads);
  Study heights_study = study.Beside("heights", {.folder = photos, .place = "", .model = ""}, {{"prepare.holdout", "list:" + held_out.string()}});

  const std::vector<int> heights = RisingHeights(plan);
  ScaleOptions scales{.divisors = {1}, .groups = {}, .area = FlownArea(heights_study.survey())};
  for (const int height_m : heights) scales.groups.push_back(HeightPrefix(height_m));
  heights_study.MeasureScales(std::move(scales));
  const std::vector<ScaleMethod> methods = {{0, false}, {0, true}, {1, false}, {1, true}};
  std::vector<MethodResults> results;
  for (const Flown& flown : FlownChoices(plan)) {
    std::vector<MethodResults> own = RunMethods(heights_study, "from" + flown.name, methods, options, flown.photos, [&options](size_t) {
      return std::vector<config::Override>{{"run.time_budget_s", fmt::format("{}", options.budget_s)}};
    });
    if (const std::string verdict = HeightVerdict(own, heights); !verdict.empty()) bench->page.verdicts.push_back(verdict);
    for (MethodResults& m : own) {
      bench->results.insert(bench->results.end(), m.seeds.begin(), m.seeds.end());
      results.push_back(std::move(m));
    }
  }
  const std::string title = "Photos and renderings from several heights";
  bench->page.sections.push_back(
      {.id = "heights",
       .title = title,
       .lead = fmt::format("The place '{}' photographed from each height and from both at an equal number of photos, {:g} s of "
                           "training each, rendered from these heights, from closer and from farther away.",
                           options.place, options.budget_s),
       .charts = {HeightChart(results, heights, title)},
       .tables = {HeightTable(results, heights)},
       .pictures = {}});
  for (const int height_m : {heights.front(), heights.back()}) {
    bench->page.sections.push_back(CropSection(results, {.folder = study.folder(),
                                                         .runs = "heights/",
                                                         .id = fmt::format("crops_{}m", height_m),
                                                         .title = fmt::format("Images from {} m", height_m),
                                                         .group = HeightPrefix(height_m),
                                                         .divisor = 1,
                                                         .pixels = 160,
                                                         .averaged = false}));
  }
}

}  // namespace skyquilt::bench
