#include "surface/texture/texels.h"

#include <limits>

#include "core/base/cancel.h"

namespace skyquilt::surface {
namespace {

constexpr float kTexelReach2 = 0.5F;  // square of half the diagonal of a texel

// Texels of one chart.
std::vector<Texel> TexelsOfChart(const TileGeometry& geometry, const AtlasLayout& layout, size_t c) {
  constexpr float kFree = std::numeric_limits<float>::infinity();
  constexpr float kCentre = -1.0F;
  const Chart& chart = layout.charts[c];
  const auto width = static_cast<size_t>(chart.size.x());
  const size_t n = width * static_cast<size_t>(chart.size.y());
  const auto index_of = [&](int x, int y) { return static_cast<size_t>(y - chart.corner.y()) * width + static_cast<size_t>(x - chart.corner.x()); };
  std::vector<Texel> grid(n);
  std::vector<float> distance2(n, kFree);  // from the centre to its place on the mesh; kCentre: it is inside
  for (const uint32_t t : chart.triangle) {
    ForEachCentreInside(layout.lattice.Of(chart.direction, geometry, t), [&](int x, int y, double b1, double b2) {
      const size_t i = index_of(x, y);
      if (distance2[i] == kCentre) return;
      distance2[i] = kCentre;
      grid[i] = {.triangle = t, .b1 = static_cast<float>(b1), .b2 = static_cast<float>(b2)};
    });
  }
  for (const uint32_t t : chart.triangle) {
    const TexelTriangle corners = layout.lattice.Of(chart.direction, geometry, t);
    ForEachTexelNear(corners, [&](int x, int y) {
      const size_t i = index_of(x, y);
      if (distance2[i] == kCentre) return;
      const NearestPoint nearest = NearestOnEdges(corners, {x + 0.5, y + 0.5});
      const auto d2 = static_cast<float>(nearest.distance2);
      if (!(d2 <= kTexelReach2) || !(d2 < distance2[i])) return;
      distance2[i] = d2;
      grid[i] = {.triangle = t, .b1 = static_cast<float>(nearest.b1), .b2 = static_cast<float>(nearest.b2), .border = true};
    });
  }
  std::vector<Texel> texels;
  for (size_t i = 0; i < n; ++i) {
    if (distance2[i] == kFree) continue;
    Texel texel = grid[i];
    texel.x = static_cast<uint16_t>(static_cast<size_t>(layout.corner[c].x()) + i % width);
    texel.y = static_cast<uint16_t>(static_cast<size_t>(layout.corner[c].y()) + i / width);
    texels.push_back(texel);
  }
  return texels;
}

}  // namespace

AtlasTexels FindTexels(const TileGeometry& geometry, const AtlasLayout& layout, base::ThreadPool& threads) {
  std::vector<std::vector<Texel>> of_chart(layout.charts.size());
  threads.ParallelFor(static_cast<int64_t>(of_chart.size()), [&](int64_t c, int) {
    base::ThrowIfCancelled();
    of_chart[static_cast<size_t>(c)] = TexelsOfChart(geometry, layout, static_cast<size_t>(c));
  });
  AtlasTexels all;
  all.first.push_back(0);
  for (std::vector<Texel>& texels : of_chart) {
    all.texel.insert(all.texel.end(), texels.begin(), texels.end());
    all.first.push_back(all.texel.size());
    texels = {};
  }
  return all;
}

}  // namespace skyquilt::surface
