#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/study/scales_parts.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

constexpr double kFasterAtAnEighth = 60.0;  // an eighth frame has a 64th of the rays

const ScaleScore* ScoreOf(const VariantResult& result, const std::string& group, int divisor, bool averaged) {
  const auto at = std::find_if(result.scales.begin(), result.scales.end(),
                               [&](const ScaleScore& s) { return s.group == group && s.divisor == divisor && s.averaged == averaged; });
  return at == result.scales.end() ? nullptr : &*at;
}

template <typename Value>
double MedianOver(const std::vector<VariantResult>& seeds, const std::string& group, int divisor, bool averaged, const Value& value) {
  std::vector<double> values;
  for (const VariantResult& r : seeds) {
    if (const ScaleScore* score = ScoreOf(r, group, divisor, averaged)) values.push_back(value(*score));
  }
  return evaluate::MedianOfMeasured(std::move(values));
}

// "1/8 (80 px)"
std::string WidthTitle(const std::vector<MethodResults>& methods, int divisor) {
  for (const MethodResults& m : methods) {
    for (const VariantResult& r : m.seeds) {
      if (const ScaleScore* score = ScoreOf(r, "", divisor, false)) return fmt::format("{} ({} px)", FractionName(divisor), score->width);
    }
  }
  return FractionName(divisor);
}

BenchTable WithWidths(const std::vector<MethodResults>& methods, const std::string& name, const std::string& title, const std::string& note) {
  BenchTable table{.name = name, .title = title, .note = note, .columns = {"method"}, .rows = {}};
  for (const int divisor : DivisorsOf(methods)) table.columns.push_back(WidthTitle(methods, divisor));
  return table;
}

}  // namespace

std::string WidthName(int divisor) {
  return divisor == 1 ? "full width" : FractionName(divisor) + " of the width";
}

std::string FractionName(int divisor) {
  return divisor == 1 ? "1" : fmt::format("1/{}", divisor);
}

double MethodResults::Psnr(const std::string& group, int divisor, bool averaged) const {
  return MedianOver(seeds, group, divisor, averaged, [](const ScaleScore& s) { return s.psnr_db; });
}

double MethodResults::FrameSeconds(const std::string& group, int divisor) const {
  return MedianOver(seeds, group, divisor, false, [](const ScaleScore& s) { return s.frame_seconds; });
}

Difference PsnrDifferenceAt(const MethodResults& of, const MethodResults& against, const std::string& group, int divisor) {
  std::vector<double> differences;
  for (size_t i = 0; i < std::min(of.seeds.size(), against.seeds.size()); ++i) {
    const ScaleScore *a = ScoreOf(of.seeds[i], group, divisor, false), *b = ScoreOf(against.seeds[i], group, divisor, false);
    if (a != nullptr && b != nullptr) differences.push_back(a->psnr_db - b->psnr_db);
  }
  return DifferenceOf(std::move(differences), kNoise_db);
}

std::vector<int> DivisorsOf(const std::vector<MethodResults>& methods) {
  std::set<int> divisors;
  for (const MethodResults& m : methods) {
    for (const VariantResult& r : m.seeds) {
      for (const ScaleScore& s : r.scales) divisors.insert(s.divisor);
    }
  }
  return {divisors.begin(), divisors.end()};
}

BenchTable ScaleTable(const std::vector<MethodResults>& methods, const std::string& name) {
  BenchTable table = WithWidths(methods, name, "PSNR by width",
                                "Full frames, mean over held-out photos, median over trainings. k x k rays: rendered at full width, "
                                "then averaged in linear light.");
  const std::vector<int> divisors = DivisorsOf(methods);
  for (const MethodResults& m : methods) {
    for (const bool averaged : {false, true}) {
      std::vector<BenchCell> row = {BenchCell::Text(averaged ? m.label + ", k x k rays" : m.label)};
      for (const int divisor : divisors) row.push_back(BenchCell::Number(m.Psnr("", divisor, averaged && divisor > 1), 2, "dB"));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

BenchTable FrameTimeTable(const std::vector<MethodResults>& methods, const std::string& name) {
  BenchTable table = WithWidths(methods, name, "Time per frame", "One ray per pixel, median over held-out photos.");
  const std::vector<int> divisors = DivisorsOf(methods);
  if (divisors.empty()) return table;
  table.columns.push_back(fmt::format("{} is faster", FractionName(divisors.back())));
  for (const MethodResults& m : methods) {
    std::vector<BenchCell> row = {BenchCell::Text(m.label)};
    for (const int divisor : divisors) row.push_back(BenchCell::Number(1e3 * m.FrameSeconds("", divisor), 1, "ms"));
    row.push_back(BenchCell::Number(m.FrameSeconds("", divisors.front()) / m.FrameSeconds("", divisors.back()), 0, "times"));
    table.rows.push_back(std::move(row));
  }
  return table;
}

BenchTable TrainingTable(const std::vector<MethodResults>& methods, const std::string& name) {
  BenchTable table = WithWidths(methods, name, "Trainings", "Steps: mean over blocks. Widths: PSNR with one ray per pixel.");
  table.columns.insert(table.columns.begin() + 1, {"photos", "training", "steps", "samples"});
  const std::vector<int> divisors = DivisorsOf(methods);
  for (const MethodResults& m : methods) {
    for (const VariantResult& r : m.seeds) {
      double steps = 0.0;
      for (const VariantField& field : r.fields) {
        if (field.name != "context") steps += static_cast<double>(field.steps) / std::max(1, r.blocks);
      }
      std::vector<BenchCell> row = {BenchCell::Text(r.failure.empty() ? r.label : r.label + " (" + r.failure + ")"),
                                    BenchCell::Number(r.training_photos, 0), BenchCell::Seconds(r.train_seconds), BenchCell::Number(steps, 0),
                                    BenchCell::Count(r.samples)};
      for (const int divisor : divisors) {
        const ScaleScore* score = ScoreOf(r, "", divisor, false);
        row.push_back(BenchCell::Number(score == nullptr ? VariantResult::kNone : score->psnr_db, 2, "dB"));
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

std::string ScaleChart(const std::vector<MethodResults>& methods, const std::string& title) {
  std::vector<page::Curve> curves;
  const std::vector<int> divisors = DivisorsOf(methods);
  const auto add = [&](const MethodResults& m, bool averaged) {
    page::Curve curve{.name = averaged ? m.label + ", k x k rays" : m.label, .points = {}, .marks = true, .hollow = averaged};
    for (const int divisor : divisors) curve.points.emplace_back(divisor, m.Psnr("", divisor, averaged && divisor > 1));
    curves.push_back(std::move(curve));
  };
  for (const MethodResults& m : methods) add(m, false);
  if (const MethodResults* points = Find(methods, {})) add(*points, true);
  return page::CurveChart(curves, {.title = title, .x_label = "width of the photo / width of the image", .y_label = "PSNR (dB)", .log_x = true});
}

const MethodResults* Find(const std::vector<MethodResults>& methods, const ScaleMethod& method) {
  const auto at = std::find_if(methods.begin(), methods.end(), [&method](const MethodResults& m) {
    return m.method.positions == method.positions && m.method.pyramid == method.pyramid;
  });
  return at == methods.end() ? nullptr : &*at;
}

const MethodResults* BestCones(const std::vector<MethodResults>& methods) {
  const MethodResults* best = nullptr;
  double best_db = -std::numeric_limits<double>::infinity();
  for (const MethodResults& m : methods) {
    std::vector<double> small_db;
    for (const int divisor : DivisorsOf(methods)) {
      if (divisor > 1) small_db.push_back(m.Psnr("", divisor, false));
    }
    const double db = evaluate::MeanOfMeasured(small_db);
    if (m.method.positions == 0 || !(db > best_db)) continue;
    best = &m;
    best_db = db;
  }
  return best;
}

std::vector<std::string> ScaleVerdicts(const std::vector<MethodResults>& methods, const std::string& condition) {
  std::vector<std::string> verdicts;
  const MethodResults* points = Find(methods, {});
  const MethodResults* cones = BestCones(methods);
  if (points == nullptr || cones == nullptr) return verdicts;
  const std::vector<int> divisors = DivisorsOf(methods);
  for (const int divisor : divisors) {
    const double before = points->Psnr("", divisor, false), after = cones->Psnr("", divisor, false);
    const std::string change = Shown(PsnrDifferenceAt(*cones, *points, "", divisor));
    verdicts.push_back(fmt::format("{}, at {}: '{}' against '{}': {} ({:.2f} against {:.2f}; with k x k rays {:.2f} and {:.2f}).", condition,
                                   WidthName(divisor), cones->label, points->label, change, after, before, cones->Psnr("", divisor, divisor > 1),
                                   points->Psnr("", divisor, divisor > 1)));
  }
  const double faster = cones->FrameSeconds("", divisors.front()) / cones->FrameSeconds("", divisors.back());
  if (divisors.back() == 8 && std::isfinite(faster)) {
    verdicts.push_back(
        fmt::format("{}: '{}' renders a frame of an eighth {:.0f} times as fast as a full one; at least {:.0f} times is the target, {}.", condition,
                    cones->label, faster, kFasterAtAnEighth, faster >= kFasterAtAnEighth ? "met" : "missed"));
  }
  return verdicts;
}

}  // namespace skyquilt::bench
