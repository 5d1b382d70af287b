// A ray has the same bits however it is cut into windows, whoever renders them, and however little memory there is.
#include "core/scene/paged_renderer.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/base/random.h"
#include "tests/support/error_of.h"
#include "tests/support/random_scene.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::scene {
namespace {

constexpr int kRows = 2, kColumns = 3;

std::vector<render::Ray> SlantedRays(int n, uint64_t seed) {
  base::Random random(seed);
  std::vector<render::Ray> rays;
  for (int i = 0; i < n; ++i) {
    render::Ray ray;
    ray.origin_enu = {random.Uniform(-6.0, 21.0), random.Uniform(-6.0, 16.0), random.Uniform(2.0, 9.0)};
    ray.direction_enu = Eigen::Vector3d{random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0), random.Uniform(-0.6, 0.1)}.normalized();
    if (i % 7 == 0) ray.direction_enu = {0.0, 0.0, -1.0};
    if (i % 7 == 1) ray.origin_enu.x() = kRandomBlock_m;  // along a border
    if (i % 7 == 2) ray.pixel_pitch = 0.02F;
    if (i % 7 == 3) ray.t_near = 2.0, ray.t_far = 9.0;
    rays.push_back(ray);
  }
  return rays;
}

bool SameBits(const render::RayColor& a, const render::RayColor& b) {
  const auto same = [](float x, float y) { return std::memcmp(&x, &y, sizeof x) == 0 || (std::isnan(x) && std::isnan(y)); };
  for (size_t c = 0; c < 3; ++c) {
    if (!same(a.rgb_srgb[c], b.rgb_srgb[c]) || !same(a.concealed_light[c], b.concealed_light[c])) return false;
  }
  return same(a.opacity, b.opacity) && same(a.depth, b.depth) && same(a.depth_median, b.depth_median) && same(a.depth_front, b.depth_front) &&
         same(a.depth_back, b.depth_back);
}

class PagedRendererTest : public ::testing::TestWithParam<std::tuple<double, bool, double>> {
 protected:
  PagedRendererTest() : threads_(2) {
    const auto [margin_m, hard, bias] = GetParam();
    hard_ = hard;
    WriteRandomScene(folder_ / "scene.h5", kRows, kColumns, margin_m, bias, true);
    store_ = std::make_unique<FieldStore>(checkpoint::ArchiveReader(folder_ / "scene.h5"), folder_ / "scene.h5", 0.0, hard);
    store_->EnsureAllLoaded();
    fields_.blocks = store_->Blocks();
    fields_.context = &store_->context();
  }

  FieldStore Small(double memory_bytes) const { return {checkpoint::ArchiveReader(folder_ / "scene.h5"), folder_ / "scene.h5", memory_bytes, hard_}; }
  std::vector<render::RayColor> Whole(const std::vector<render::Ray>& rays) {
    std::vector<render::RayColor> out(rays.size());
    render::RenderRays(fields_, rays, out, {}, threads_);
    return out;
  }

  TemporaryFolder folder_;
  base::ThreadPool threads_;
  std::unique_ptr<FieldStore> store_;
  render::FieldSet fields_;
  bool hard_ = false;
};

TEST_P(PagedRendererTest, WindowsCutAnywhereGiveTheSameBits) {
  const std::vector<render::Ray> rays = SlantedRays(200, 3);
  const std::vector<render::RayColor> whole = Whole(rays);
  int opaque = 0;
  for (const render::RayColor& color : whole) opaque += color.opacity > 0.05F ? 1 : 0;
  EXPECT_GT(opaque, 40);
  base::Random random(8);
  render::RayRenderer renderer(fields_, {});
  std::vector<render::RayState> states(rays.size());
  std::vector<render::Window> windows(rays.size());
  for (int piece = 0; piece < 6; ++piece) {
    for (render::Window& window : windows) {
      window.from = piece == 0 ? 0.0 : window.to;
      window.to = piece == 5 ? std::numeric_limits<double>::infinity() : window.from + random.Uniform(0.0, 6.0);
    }
    renderer.Continue(rays, windows, states);
  }
  for (size_t i = 0; i < rays.size(); ++i) EXPECT_TRUE(SameBits(render::FinalColor(states[i]), whole[i])) << i;
}

TEST_P(PagedRendererTest, LittleMemoryGivesTheSameBits) {
  const std::vector<render::Ray> rays = SlantedRays(300, 4);
  const std::vector<render::RayColor> whole = Whole(rays);
  // Memory for the context and the four blocks that overlap at a corner.
  const double enough = store_->ContextBytes() + 4.2 * store_->Bytes(0);
  FieldStore small = Small(enough);
  ASSERT_FALSE(small.AllFit());
  const render::RaySegments segments(small.Blocks());
  std::vector<RayInFlight> in_flight(rays.size());
  PagedRenderer(small, segments, threads_).Continue(rays, in_flight, {}, 0, {});
  for (size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(in_flight[i].owner, kFinished);
    EXPECT_TRUE(SameBits(render::FinalColor(in_flight[i].state), whole[i])) << i;
  }
  EXPECT_LE(small.peak_bytes(), enough);
  // Rays through opaque blocks end before they come to one that was unloaded.
  const bool opaque = std::get<2>(GetParam()) > 0.0;
  if (!opaque) EXPECT_GT(small.loads(), kRows * kColumns + 1) << "blocks are loaded again when they are needed";
}

TEST_P(PagedRendererTest, ManyOwnersGiveTheSameBits) {
  const std::vector<render::Ray> rays = SlantedRays(300, 5);
  const std::vector<render::RayColor> whole = Whole(rays);
  constexpr int kOwners = 3;
  std::vector<std::unique_ptr<FieldStore>> stores;
  std::vector<std::unique_ptr<render::RaySegments>> segments;
  for (int i = 0; i < kOwners; ++i) {
    stores.push_back(std::make_unique<FieldStore>(Small(0.0)));
    segments.push_back(std::make_unique<render::RaySegments>(stores.back()->Blocks()));
  }
  const auto owner_for = [](int me) { return [me](std::span<const int> blocks) { return blocks.empty() ? me : blocks.front() % kOwners; }; };
  std::vector<RayInFlight> in_flight(rays.size());
  int rounds = 0;
  for (bool going = true; going; ++rounds) {
    ASSERT_LT(rounds, 40) << "a ray is passed around without end";
    for (int me = 0; me < kOwners; ++me) {
      // Owners continue only the rays that were given to them.
      std::vector<render::Ray> own;
      std::vector<RayInFlight> mine;
      std::vector<size_t> place;
      for (size_t i = 0; i < rays.size(); ++i) {
        if (in_flight[i].owner != me) continue;
        own.push_back(rays[i]);
        mine.push_back(in_flight[i]);
        place.push_back(i);
      }
      PagedRenderer(*stores[static_cast<size_t>(me)], *segments[static_cast<size_t>(me)], threads_).Continue(own, mine, {}, me, owner_for(me));
      for (size_t k = 0; k < place.size(); ++k) {
        EXPECT_NE(mine[k].owner, me);
        in_flight[place[k]] = mine[k];
      }
    }
    going = std::any_of(in_flight.begin(), in_flight.end(), [](const RayInFlight& t) { return t.owner != kFinished; });
  }
  // Rays through opaque blocks may all end with their first owner.
  if (std::get<2>(GetParam()) <= 0.0) EXPECT_GT(rounds, 1) << "no ray was passed on";
  for (size_t i = 0; i < rays.size(); ++i) EXPECT_TRUE(SameBits(render::FinalColor(in_flight[i].state), whole[i])) << i;
  for (const auto& store : stores) {
    int loaded = 0;
    for (int k = 0; k < store->size(); ++k) loaded += store->IsLoaded(k) ? 1 : 0;
    EXPECT_LT(loaded, store->size()) << "an owner loads only the blocks of its segments";
  }
}

TEST_P(PagedRendererTest, TooLittleMemoryIsAUsageError) {
  FieldStore tiny = Small(0.5 * store_->Bytes(0));
  const render::RaySegments segments(tiny.Blocks());
  const std::vector<render::Ray> rays = SlantedRays(50, 6);
  std::vector<RayInFlight> in_flight(rays.size());
  const std::string error = UsageErrorOf([&] { PagedRenderer(tiny, segments, threads_).Continue(rays, in_flight, {}, 0, {}); });
  EXPECT_NE(error.find("--memory"), std::string::npos) << error;
}

INSTANTIATE_TEST_SUITE_P(BordersAndDensity, PagedRendererTest,
                         ::testing::Values(std::tuple(0.6, false, -2.0), std::tuple(0.6, true, -2.0), std::tuple(0.0, false, -3.0),
                                           std::tuple(1.0, false, 2.0)));

RC_GTEST_PROP(RaySegmentsProperty, SegmentsCoverTheRayAndListItsBlocks, ()) {
  const int n = *rc::gen::inRange(0, 6);
  std::vector<render::TrainedField> blocks(static_cast<size_t>(n));
  for (render::TrainedField& block : blocks) {
    const double x = *rc::gen::inRange(-10, 10), y = *rc::gen::inRange(-10, 10);
    block.box.min_enu = {x, y, 0.0};
    block.box.max_enu = {x + *rc::gen::inRange(1, 8), y + *rc::gen::inRange(1, 8), 3.0};
    block.blend_m = 0.25 * *rc::gen::inRange(0, 5);
  }
  std::vector<const render::TrainedField*> outlines;
  for (const render::TrainedField& block : blocks) outlines.push_back(&block);
  render::Ray ray;
  ray.origin_enu = {0.5 * *rc::gen::inRange(-30, 30), 0.5 * *rc::gen::inRange(-30, 30), 5.0};
  ray.direction_enu = {0.1 * *rc::gen::inRange(-10, 11), 0.1 * *rc::gen::inRange(-10, 11), -0.3};
  ray.direction_enu.normalize();
  const render::RaySegments segments(outlines);
  std::vector<render::RaySegment> found;
  render::RaySplitter(segments).Split(ray, &found);
  RC_ASSERT(!found.empty());
  RC_ASSERT(std::isinf(found.back().t_far));
  double from = 0.0;
  for (size_t i = 0; i < found.size(); ++i) {
    RC_ASSERT(found[i].t_far > from);
    if (i > 0) RC_ASSERT(found[i].set != found[i - 1].set);
    const double middle = std::isinf(found[i].t_far) ? from + 1.0 : 0.5 * (from + found[i].t_far);
    const Eigen::Vector3d place = ray.origin_enu + middle * ray.direction_enu;
    const std::span<const int> named = segments.Blocks(found[i].set);
    for (int k = 0; k < n; ++k) {
      const render::TrainedField& b = blocks[static_cast<size_t>(k)];
      const bool level = place.z() > 1e-9 && place.z() < 3.0 - 1e-9, not_level = place.z() < -1e-9 || place.z() > 3.0 + 1e-9;
      const bool inside = level && (place.head<2>().array() > b.box.min_enu.head<2>().array() - b.blend_m + 1e-9).all() &&
                          (place.head<2>().array() < b.box.max_enu.head<2>().array() + b.blend_m - 1e-9).all();
      if (inside) RC_ASSERT(std::find(named.begin(), named.end(), k) != named.end());
      const bool outside = not_level || (place.head<2>().array() < b.box.min_enu.head<2>().array() - b.blend_m - 1e-9).any() ||
                           (place.head<2>().array() > b.box.max_enu.head<2>().array() + b.blend_m + 1e-9).any();
      if (outside) RC_ASSERT(std::find(named.begin(), named.end(), k) == named.end());
    }
    from = found[i].t_far;
  }
}

}  // namespace
}  // namespace skyquilt::scene
