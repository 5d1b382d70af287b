// Rays per second through scenes of few and of many blocks, on one thread. The same rays pass the same four blocks in the middle of every scene, so
// their cost should not depend on how many other blocks there are.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "core/base/random.h"
#include "core/render/ray_engine.h"
#include "core/render/ray_segments.h"
#include "tests/support/random_field.h"

namespace skyquilt {
namespace {

constexpr double kEdge_m = 20.0, kHeight_m = 8.0, kMargin_m = 2.0;
constexpr size_t kRaysOfCall = 4096;

// A square of blocks around the origin, with a context.
struct ManyBlocks {
  explicit ManyBlocks(int n_blocks) {
    const int side = static_cast<int>(std::lround(std::sqrt(n_blocks)));
    const double low = -0.5 * side * kEdge_m;
    blocks.reserve(static_cast<size_t>(side) * static_cast<size_t>(side));
    for (int row = 0; row < side; ++row) {
      for (int column = 0; column < side; ++column) {
        const Eigen::Vector3d corner(low + kEdge_m * column, low + kEdge_m * row, 0.0);
        // The blocks in the middle are the same in all scenes.
        const auto seed = static_cast<uint64_t>(1000 + (row - side / 2) * 100 + column - side / 2);
        blocks.push_back(render::RandomField(seed, corner, corner + Eigen::Vector3d(kEdge_m, kEdge_m, kHeight_m), kMargin_m, -2.0));
      }
    }
    context = render::RandomField(5, {low, low, 0.0}, {-low, -low, kHeight_m}, 0.0, -3.0, true);
    for (const render::TrainedField& block : blocks) fields.blocks.push_back(&block);
    fields.context = &context;
  }

  std::vector<render::TrainedField> blocks;
  render::TrainedField context;
  render::FieldSet fields;
};

const ManyBlocks& SceneOf(int64_t n_blocks) {
  static std::map<int64_t, std::unique_ptr<ManyBlocks>> scenes;
  std::unique_ptr<ManyBlocks>& scene = scenes[n_blocks];
  if (!scene) scene = std::make_unique<ManyBlocks>(static_cast<int>(n_blocks));
  return *scene;
}

// Of one photo, 25 m above the corner of the four blocks in the middle.
std::vector<render::Ray> PictureRays() {
  base::Random random(1);
  std::vector<render::Ray> rays(kRaysOfCall);
  for (render::Ray& ray : rays) {
    ray.origin_enu = {0.5, -0.5, 25.0};
    const double x = random.Uniform(-0.6, 0.6), y = random.Uniform(-0.6, 0.6);
    ray.direction_enu = Eigen::Vector3d(x, y, -1.0).normalized();
    ray.pixel_pitch = 0.002F;
  }
  return rays;
}

// Straight down on rows of a map.
std::vector<render::Ray> MapRays() {
  std::vector<render::Ray> rays(kRaysOfCall);
  constexpr size_t kColumns = 64;
  for (size_t i = 0; i < rays.size(); ++i) {
    const double x = 0.55 * (static_cast<double>(i % kColumns) - 0.5 * kColumns), y = 0.55 * (static_cast<double>(i / kColumns) - 0.5 * kColumns);
    rays[i].origin_enu = {x, y, 12.0};
    rays[i].direction_enu = {0.0, 0.0, -1.0};
    rays[i].pixel_width = 0.1F;
  }
  return rays;
}

void Render(benchmark::State& state, const std::vector<render::Ray>& rays) {
  render::RayRenderer renderer(SceneOf(state.range(0)).fields, {});
  std::vector<render::RayColor> colors(rays.size());
  for (auto _ : state) {
    renderer.Render(rays, colors);
    benchmark::DoNotOptimize(colors.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(rays.size()));
}

void RenderPictureRays(benchmark::State& state) {
  Render(state, PictureRays());
}

void RenderMapRays(benchmark::State& state) {
  Render(state, MapRays());
}

// What rank 0 does with every ray where ranks share a scene.
void SplitPictureRays(benchmark::State& state) {
  const render::RaySegments sets(SceneOf(state.range(0)).fields.blocks);
  render::RaySplitter splitter(sets);
  const std::vector<render::Ray> rays = PictureRays();
  std::vector<render::RaySegment> segments;
  for (auto _ : state) {
    for (const render::Ray& ray : rays) {
      segments.clear();
      splitter.Split(ray, &segments);
    }
    benchmark::DoNotOptimize(segments.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(rays.size()));
}

void NumbersOfBlocks(benchmark::internal::Benchmark* bench) {
  bench->ArgName("blocks")->Arg(4)->Arg(400)->Arg(1600)->Unit(benchmark::kMillisecond);
}
BENCHMARK(RenderPictureRays)->Apply(NumbersOfBlocks);
BENCHMARK(RenderMapRays)->Apply(NumbersOfBlocks);
BENCHMARK(SplitPictureRays)->Apply(NumbersOfBlocks);

}  // namespace
}  // namespace skyquilt
