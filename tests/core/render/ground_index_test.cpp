// What is found through the index is what asking every block finds: blocks near a ray, its samples and its segments.
#include "core/render/ground_index.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <limits>

#include "core/render/march.h"
#include "core/render/ray_segments.h"
#include "core/render/sample_marcher.h"
#include "tests/core/render/block_scenes.h"

namespace skyquilt::render {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Blocks that are only places.
std::vector<TrainedField> Places(int rows, int columns, double edge_m, double margin_m) {
  std::vector<TrainedField> blocks;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      TrainedField block;
      block.box.min_enu = {edge_m * column, edge_m * row, 0.0};
      block.box.max_enu = {edge_m * (column + 1), edge_m * (row + 1), 20.0};
      block.box.margin_m = block.blend_m = margin_m;
      block.map = encoding::SpaceMap::Box(block.box.TrainMin(), block.box.TrainMax());
      blocks.push_back(std::move(block));
    }
  }
  return blocks;
}

std::vector<const TrainedField*> PointersTo(const std::vector<TrainedField>& blocks) {
  std::vector<const TrainedField*> pointers;
  for (const TrainedField& block : blocks) pointers.push_back(&block);
  return pointers;
}

TEST(GroundIndex, FindsNothingWithoutBlocks) {
  const GroundIndex index({});
  std::vector<int> found = {7};
  const Ray ray{.origin_enu = {0, 0, 1}, .direction_enu = {0, 0, -1}};
  index.Find(ray, {0.0, kInfinity}, &found);
  EXPECT_TRUE(found.empty());
  EXPECT_TRUE(index.HeightInterval(ray).Empty());
}

TEST(GroundIndex, CostsLittleAmongManyBlocks) {
  const std::vector<TrainedField> blocks = Places(40, 40, 100.0, 10.0);
  const GroundIndex index(PointersTo(blocks));
  std::vector<int> found;
  index.Find({.origin_enu = {2050.0, 1950.0, 300.0}, .direction_enu = {0, 0, -1}}, {0.0, kInfinity}, &found);
  EXPECT_LE(found.size(), 9U);
  EXPECT_TRUE(std::ranges::count(found, 40 * 19 + 20) == 1);
  // A ray of a photo, as far as it is at the heights of the blocks.
  const Ray slanted{.origin_enu = {2050.0, 1950.0, 120.0}, .direction_enu = Eigen::Vector3d(0.5, 0.3, -0.8).normalized()};
  index.Find(slanted, index.HeightInterval(slanted), &found);
  EXPECT_LE(found.size(), 16U);
  // The whole survey along its middle.
  index.Find({.origin_enu = {-10.0, 2050.0, 5.0}, .direction_enu = {1, 0, 0}}, {0.0, kInfinity}, &found);
  EXPECT_LE(found.size(), 3U * 40U);
}

RC_GTEST_PROP(GroundIndexProperty, MissesNoBlock, ()) {
  // Blocks of any sizes, which may overlap.
  std::vector<TrainedField> blocks(static_cast<size_t>(*rc::gen::inRange(1, 12)));
  const double far_away = *rc::gen::element(0.0, 0.0, 5e5);
  for (TrainedField& block : blocks) {
    const double x = far_away + *rc::gen::inRange(-10, 10), y = *rc::gen::inRange(-10, 10);
    block.box.min_enu = {x, y, 0.0};
    block.box.max_enu = {x + *rc::gen::inRange(1, 8), y + *rc::gen::inRange(1, 30), 3.0};
    block.blend_m = 0.25 * *rc::gen::inRange(0, 5);
    block.box.margin_m = 0.5;
    block.map = encoding::SpaceMap::Box(block.box.TrainMin(), block.box.TrainMax());
  }
  Ray ray = AnyRay();
  ray.origin_enu.x() += far_away;
  const geo::Interval within{0.5 * *rc::gen::inRange(0, 20), *rc::gen::element(kInfinity, 1e30, 12.0, 3.0)};
  const GroundIndex index(PointersTo(blocks));
  std::vector<int> found;
  index.Find(ray, within, &found);
  RC_ASSERT(std::adjacent_find(found.begin(), found.end(), std::greater_equal<>()) == found.end());
  for (size_t k = 0; k < blocks.size(); ++k) {
    const TrainedField& block = blocks[k];
    const bool met = !Intersection(BlendInterval(block, ray), within).Empty() ||
                     !Intersection(PlanInterval(block.map, ray.origin_enu, ray.direction_enu), within).Empty();
    if (met) RC_ASSERT(std::ranges::count(found, static_cast<int>(k)) == 1);
  }
}

// The marcher in its simplest form: every block is asked, and every block is weighed at every sample.
class PlainMarcher {
 public:
  PlainMarcher(const FieldSet& fields, const Ray& ray, const Window& window) : fields_(fields), ray_(ray), window_(window) {
    if (fields_.context != nullptr) gaps_.push_back(Clip(*fields_.context));
    for (size_t k = 0; k < fields_.blocks.size(); ++k) {
      if (PlanInterval(fields_.blocks[k]->map, ray.origin_enu, ray.direction_enu).Empty()) continue;
      candidates_.push_back(static_cast<int>(k));
      if (fields_.context != nullptr) CutCore(Core(*fields_.blocks[k]));
    }
    weights_.resize(candidates_.size());
    for (size_t c = 0; c < candidates_.size(); ++c) {
      const TrainedField& f = *fields_.blocks[static_cast<size_t>(candidates_[c])];
      if (window_.Overlaps(BlendInterval(f, ray_))) MarchField(f, candidates_[c], static_cast<int>(c), Clip(f));
    }
    for (const geo::Interval& gap : gaps_) {
      if (window_.Overlaps(gap)) MarchField(*fields_.context, static_cast<int>(fields_.blocks.size()), -1, gap);
    }
    std::ranges::stable_sort(samples_, [](const Sample& a, const Sample& b) { return a.t < b.t; });
  }
  const std::vector<Sample>& samples() const { return samples_; }

 private:
  geo::Interval Clip(const TrainedField& f) const {
    return Intersection(FieldInterval(f.map, ray_.origin_enu, ray_.direction_enu), {ray_.t_near, ray_.t_far});
  }
  geo::Interval Core(const TrainedField& f) const {
    const double m = f.blend_m;
    return geo::RayBox(ray_.origin_enu, ray_.direction_enu, {f.box.min_enu.x() + m, f.box.min_enu.y() + m, -kInfinity},
                       {f.box.max_enu.x() - m, f.box.max_enu.y() - m, kInfinity});
  }
  void CutCore(const geo::Interval& core) {
    if (core.Empty()) return;
    const size_t n = gaps_.size();
    for (size_t i = 0; i < n; ++i) {
      const geo::Interval gap = gaps_[i];
      if (core.t_far <= gap.t_near || core.t_near >= gap.t_far) continue;
      gaps_[i].t_far = std::min(gap.t_far, core.t_near);
      if (gap.t_far > core.t_far) gaps_.push_back({core.t_far, gap.t_far});
    }
  }
  void MarchField(const TrainedField& f, int number, int candidate, const geo::Interval& interval) {
    const geo::Interval alone = candidate < 0 ? geo::Interval{} : Core(f);
    const UnitRay unit(f.map, ray_.origin_enu, ray_.direction_enu);
    int count = 0;
    const auto emit = [&](double t, double length, double unit_length) {
      if (!(t < window_.to)) return false;
      if (t < window_.from) return ++count < 2048;
      double weight = 1.0;
      if (!(t > alone.t_near && t < alone.t_far)) {
        const double context = BlendWeights(fields_, candidates_, ray_.origin_enu.x() + t * ray_.direction_enu.x(),
                                            ray_.origin_enu.y() + t * ray_.direction_enu.y(), weights_);
        weight = candidate < 0 ? context : weights_[static_cast<size_t>(candidate)];
      }
      if (weight > 1e-4) {
        const Eigen::Vector3f p = unit.At(t);
        samples_.push_back({t, static_cast<float>(length), static_cast<float>(unit_length / f.step_m), static_cast<float>(weight), p.x(), p.y(),
                            p.z(), count % 2 != 0, number, 0.0F, 0});
      }
      return ++count < 2048;
    };
    const double wanted_m = f.config.Cones() ? ray_.Footprint(interval.t_near) : 4.5 * static_cast<double>(ray_.pixel_pitch) * interval.t_near;
    const double step_m = f.step_m * std::max(1.0, wanted_m / f.step_m);
    if (step_m > 1.01 * f.step_m) {
      MarchCoarse(f, ray_.origin_enu, ray_.direction_enu, interval, step_m, 0.5F, emit);
    } else {
      March(f, ray_.origin_enu, ray_.direction_enu, interval, step_m, 0.5F,
            [&](double t, double length, double unit_length, int64_t) { return emit(t, length, unit_length); });
    }
  }

  const FieldSet& fields_;
  const Ray& ray_;
  const Window& window_;
  std::vector<geo::Interval> gaps_;
  std::vector<int> candidates_;
  std::vector<double> weights_;
  std::vector<Sample> samples_;
};

RC_GTEST_PROP(SampleMarcherProperty, PlacesTheSamplesOfThePlainLoop, ()) {
  const FieldSet& fields = (*rc::gen::elementOf(BlockScenes()))->fields;
  const Ray ray = AnyRay();
  Window window;
  if (*rc::gen::inRange(0, 2) == 0) window = {0.7 * *rc::gen::inRange(0, 12), 0.7 * *rc::gen::inRange(0, 40)};
  std::vector<Sample> samples;
  SampleMarcher(fields, 1.0).March(ray, window, &samples);
  const PlainMarcher plain(fields, ray, window);
  RC_ASSERT(samples.size() == plain.samples().size());
  for (size_t i = 0; i < samples.size(); ++i) {
    const Sample &a = samples[i], &b = plain.samples()[i];
    RC_ASSERT(a.t == b.t && a.length == b.length && a.unit_length == b.unit_length && a.blend == b.blend);
    RC_ASSERT(a.x == b.x && a.y == b.y && a.z == b.z && a.odd == b.odd && a.field == b.field);
  }
}

// Every block is asked, at every distance where one begins or ends.
std::vector<std::pair<double, std::vector<int>>> PlainSegments(const FieldSet& fields, const Ray& ray) {
  double low = kInfinity, high = -kInfinity;
  for (const TrainedField* f : fields.blocks) {
    low = std::min({low, f->box.min_enu.z(), f->map.min_enu().z()});
    high = std::max({high, f->box.max_enu.z(), f->map.max_enu().z()});
  }
  const geo::Interval level = geo::RayBox(ray.origin_enu, ray.direction_enu, {-kInfinity, -kInfinity, low}, {kInfinity, kInfinity, high});
  const geo::Interval reach = Intersection(level, {ray.t_near, ray.t_far});
  std::vector<double> changes = {0.0, kInfinity};
  std::vector<geo::Interval> of_block;
  for (const TrainedField* f : fields.blocks) {
    of_block.push_back(Intersection(BlendInterval(*f, ray), reach));
    if (!of_block.back().Empty()) changes.insert(changes.end(), {of_block.back().t_near, of_block.back().t_far});
  }
  std::ranges::sort(changes);
  changes.erase(std::unique(changes.begin(), changes.end()), changes.end());
  std::vector<std::pair<double, std::vector<int>>> segments;
  for (size_t i = 0; i + 1 < changes.size(); ++i) {
    std::vector<int> here;
    for (size_t k = 0; k < of_block.size(); ++k) {
      if (Window{changes[i], changes[i + 1]}.Overlaps(of_block[k])) here.push_back(static_cast<int>(k));
    }
    if (!segments.empty() && segments.back().second == here) segments.pop_back();
    segments.emplace_back(changes[i + 1], here);
  }
  return segments;
}

RC_GTEST_PROP(RaySplitterProperty, CutsAsThePlainLoop, ()) {
  const FieldSet& fields = (*rc::gen::elementOf(BlockScenes()))->fields;
  const RaySegments sets(fields.blocks);
  RaySplitter first(sets), second(sets);  // two threads' splitters give a set the same number
  for (int i = 0; i < 3; ++i) {
    const Ray ray = AnyRay();
    std::vector<RaySegment> segments, again;
    first.Split(ray, &segments);
    second.Split(ray, &again);
    const auto plain = PlainSegments(fields, ray);
    RC_ASSERT(segments.size() == plain.size() && again.size() == plain.size());
    for (size_t s = 0; s < segments.size(); ++s) {
      RC_ASSERT(segments[s].t_far == plain[s].first && segments[s].set == again[s].set);
      RC_ASSERT(std::ranges::equal(sets.Blocks(segments[s].set), plain[s].second));
    }
  }
}

}  // namespace
}  // namespace skyquilt::render
