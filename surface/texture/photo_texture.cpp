#include "surface/texture/photo_texture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <tuple>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"
#include "core/survey/picture_colors.h"

namespace skyquilt::surface {
namespace {

using Color = std::array<float, 3>;

constexpr double kLeastPhotoCosine = 0.26;  // 75 degrees
constexpr int64_t kPhotoBlocksPerTask = 64;
constexpr size_t kFewestCells = 8;           // that tell how a photo's light differs from the field's
constexpr float kStrangeDifference = 0.12F;  // of display values, mean over the cells around
constexpr float kDarkest = 0.002F;           // linear light that tells something

// Groups the texels with a colour by chart, view and square.
void MakeCells(const AtlasLayout& layout, const AtlasTexels& texels, std::span<const int32_t> view, PhotoTexture* texture) {
  texture->cell.assign(texels.texel.size(), -1);
  texture->cells.clear();
  for (size_t chart = 0; chart < layout.charts.size(); ++chart) {
    std::map<std::tuple<int32_t, int, int>, int32_t> found;
    std::vector<int> nearest;  // per cell of the chart
    const auto first_cell = static_cast<int32_t>(texture->cells.size());
    for (size_t i = texels.first[chart]; i < texels.first[chart + 1]; ++i) {
      if (view[i] < 0) continue;
      const int x = texels.texel[i].x - layout.corner[chart].x();
      const int y = texels.texel[i].y - layout.corner[chart].y();
      const auto [at, is_new] = found.try_emplace({view[i], y / kPhotoCellTexels, x / kPhotoCellTexels}, static_cast<int32_t>(texture->cells.size()));
      const int distance = std::abs(2 * (x % kPhotoCellTexels) + 1 - kPhotoCellTexels) + std::abs(2 * (y % kPhotoCellTexels) + 1 - kPhotoCellTexels);
      if (is_new) {
        texture->cells.push_back({view[i], static_cast<uint32_t>(chart), x / kPhotoCellTexels, y / kPhotoCellTexels, static_cast<uint32_t>(i)});
        nearest.push_back(distance);
      }
      PhotoCell& cell = texture->cells[static_cast<size_t>(at->second)];
      int& least = nearest[static_cast<size_t>(at->second - first_cell)];
      if (distance < least) {
        least = distance;
        cell.middle = static_cast<uint32_t>(i);
      }
      ++cell.texels;
      for (size_t k = 0; k < 3; ++k) cell.light[k] += survey::QuickLight(texture->rgb_srgb[i][k]);
      texture->cell[i] = at->second;
    }
  }
  for (PhotoCell& cell : texture->cells) {
    for (float& value : cell.light) value /= static_cast<float>(cell.texels);
  }
}

// How far a photo's mean light is from the field's colour, both as display values.
Color DifferenceOf(const Color& light, const Color& gain, const Color& field_srgb) {
  Color difference{};
  for (size_t k = 0; k < 3; ++k) difference[k] = survey::QuickDisplay(gain[k] * light[k]) - field_srgb[k];
  return difference;
}
float SizeOf(const Color& difference) {
  return (std::abs(difference[0]) + std::abs(difference[1]) + std::abs(difference[2])) / 3.0F;
}

using CellPlace = std::tuple<uint32_t, int, int>;  // chart, y, x

}  // namespace

std::vector<Color> GainsOfViews(size_t views, const PhotoTexture& texture, const TexelColors& field) {
  std::vector<std::array<std::vector<float>, 3>> ratios(views);
  for (size_t c = 0; c < texture.cells.size(); ++c) {
    if (field.known[c] == 0) continue;
    for (size_t k = 0; k < 3; ++k) {
      const float photo = texture.cells[c].light[k], of_field = survey::QuickLight(field.rgb_srgb[c][k]);
      if (photo > kDarkest && of_field > kDarkest) ratios[static_cast<size_t>(texture.cells[c].view)][k].push_back(of_field / photo);
    }
  }
  std::vector<Color> gains(views, {1.0F, 1.0F, 1.0F});
  for (size_t v = 0; v < views; ++v) {
    for (size_t k = 0; k < 3; ++k) {
      if (ratios[v][k].size() >= kFewestCells) gains[v][k] = base::UpperMedian(ratios[v][k]);
    }
  }
  return gains;
}

// A photo as one view's texels are coloured from it.
struct TexturePhotos::ViewPicture {
  const DepthView* view = nullptr;
  std::shared_ptr<const survey::PhotoPicture> picture;  // null: it may not or cannot be read
  const survey::Photo* photo = nullptr;
};

TexturePhotos::ViewPicture TexturePhotos::PictureOf(int32_t view) const {
  const DepthView& seen = views_[static_cast<size_t>(view)];
  const auto photo = static_cast<size_t>(seen.pose.photo);
  if (seen.pose.photo < 0 || photo >= survey_.photos.size() || survey_.photos[photo].is_test) return {};
  return {&seen, photos_.Of(photo), &survey_.photos[photo]};
}

std::optional<std::array<float, 3>> TexturePhotos::ColorAt(const ViewPicture& picture, uint32_t texel) const {
  const Eigen::Vector3d x = texels_.PositionOf(geometry_, texel);
  const Eigen::Vector3d to_view = picture.view->pose.Centre() - x;
  if (!(to_view.dot(texels_.NormalOf(geometry_, texel)) > kLeastPhotoCosine * to_view.norm())) return std::nullopt;
  const double tolerance_m = tolerance_m_ * (geometry_.IsFilled(texels_.texel[texel].triangle) ? kFilledTolerance : 1.0);
  if (!SeesClearly(*picture.view, x, tolerance_m)) return std::nullopt;
  const std::optional<Eigen::Vector2d> pixel = survey::PixelIn(picture.picture->camera, picture.photo->cam_from_enu, x);
  if (!pixel || survey::IsMasked(*picture.picture, *pixel)) return std::nullopt;
  return survey::LanczosAt(*picture.picture, *pixel);
}

PhotoTexture TexturePhotos::Colors(base::ThreadPool& threads) const {
  PhotoTexture texture;
  texture.rgb_srgb.resize(texels_.texel.size());
  std::vector<int32_t> view(texels_.texel.size(), -1);
  const auto paint = [&](const TexelBlock& block) {
    std::vector<uint32_t> left = block.texel;
    for (size_t k = 0; k < kKeptViews && block.view[k] >= 0 && !left.empty(); ++k) {
      const ViewPicture picture = PictureOf(block.view[k]);
      if (!picture.picture) continue;
      std::erase_if(left, [&](uint32_t i) {
        const std::optional<Color> color = ColorAt(picture, i);
        if (!color) return false;
        texture.rgb_srgb[i] = *color;
        view[i] = block.view[k];
        return true;
      });
    }
  };
  // Blocks of the same photo after each other, so that it need not be read again and again.
  std::vector<uint32_t> order(blocks_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return blocks_[a].view[0] < blocks_[b].view[0]; });
  const auto n = static_cast<int64_t>(blocks_.size());
  threads.ParallelFor((n + kPhotoBlocksPerTask - 1) / kPhotoBlocksPerTask, [&](int64_t task, int) {
    base::ThrowIfCancelled();
    for (int64_t b = task * kPhotoBlocksPerTask; b < std::min(n, (task + 1) * kPhotoBlocksPerTask); ++b)
      paint(blocks_[order[static_cast<size_t>(b)]]);
  });
  MakeCells(layout_, texels_, view, &texture);
  return texture;
}

std::vector<std::optional<Color>> TexturePhotos::ColorsAgreeing(int32_t view, std::span<const uint32_t> cell, const Color& gain,
                                                                const Color& field_srgb) const {
  const ViewPicture picture = PictureOf(view);
  if (!picture.picture) return {};
  std::vector<std::optional<Color>> colors;
  Color light{};
  float seen = 0.0F;
  for (const uint32_t i : cell) {
    const std::optional<Color>& color = colors.emplace_back(ColorAt(picture, i));
    if (!color) continue;
    for (size_t k = 0; k < 3; ++k) light[k] += survey::QuickLight((*color)[k]);
    ++seen;
  }
  if (!(seen > 0.5F * static_cast<float>(cell.size()))) return {};
  for (float& value : light) value /= seen;
  if (SizeOf(DifferenceOf(light, gain, field_srgb)) > kStrangeDifference) return {};
  return colors;
}

void TexturePhotos::ReplaceStrangers(base::ThreadPool& threads, PhotoTexture* texture, TexelColors* field) const {
  const std::vector<Color> gains = GainsOfViews(views_.size(), *texture, *field);
  std::vector<Color> difference(texture->cells.size());
  std::map<CellPlace, std::vector<int32_t>> at;  // cells of each square
  for (size_t c = 0; c < texture->cells.size(); ++c) {
    const PhotoCell& cell = texture->cells[c];
    difference[c] = DifferenceOf(cell.light, gains[static_cast<size_t>(cell.view)], field->rgb_srgb[c]);
    if (field->known[c] != 0) at[{cell.chart, cell.y, cell.x}].push_back(static_cast<int32_t>(c));
  }
  // A single cell may differ because its mesh is off by a texel at an edge: what moved is larger.
  const auto is_strange = [&](const PhotoCell& cell) {
    Color sum{};
    float n = 0.0F;
    for (int y = cell.y - 1; y <= cell.y + 1; ++y) {
      for (int x = cell.x - 1; x <= cell.x + 1; ++x) {
        const auto found = at.find({cell.chart, y, x});
        if (found == at.end()) continue;
        for (const int32_t c : found->second) {
          const PhotoCell& other = texture->cells[static_cast<size_t>(c)];
          if (other.view != cell.view) continue;
          const auto weight = static_cast<float>(other.texels);
          for (size_t k = 0; k < 3; ++k) sum[k] += weight * difference[static_cast<size_t>(c)][k];
          n += weight;
        }
      }
    }
    for (float& value : sum) value /= std::max(n, 1.0F);
    return SizeOf(sum) > kStrangeDifference;
  };
  std::vector<uint8_t> strange(texture->cells.size(), 0);
  for (size_t c = 0; c < texture->cells.size(); ++c) strange[c] = field->known[c] != 0 && is_strange(texture->cells[c]) ? 1 : 0;
  if (std::count(strange.begin(), strange.end(), 1) == 0) return;

  std::vector<int32_t> view(texture->cell.size(), -1);
  for (size_t i = 0; i < view.size(); ++i) {
    if (texture->cell[i] >= 0) view[i] = texture->cells[static_cast<size_t>(texture->cell[i])].view;
  }
  const auto replace = [&](const TexelBlock& block) {
    std::map<int32_t, std::vector<uint32_t>> of_cell;
    for (const uint32_t i : block.texel) {
      if (texture->cell[i] >= 0 && strange[static_cast<size_t>(texture->cell[i])] != 0) of_cell[texture->cell[i]].push_back(i);
    }
    for (const auto& [c, members] : of_cell) {
      for (const uint32_t i : members) view[i] = -1;
      for (size_t k = 0; k < kKeptViews && block.view[k] >= 0; ++k) {
        if (block.view[k] == texture->cells[static_cast<size_t>(c)].view) continue;
        const auto colors =
            ColorsAgreeing(block.view[k], members, gains[static_cast<size_t>(block.view[k])], field->rgb_srgb[static_cast<size_t>(c)]);
        if (colors.empty()) continue;
        for (size_t m = 0; m < members.size(); ++m) {
          if (!colors[m]) continue;
          texture->rgb_srgb[members[m]] = *colors[m];
          view[members[m]] = block.view[k];
        }
        break;
      }
    }
  };
  const auto n = static_cast<int64_t>(blocks_.size());
  threads.ParallelFor((n + kPhotoBlocksPerTask - 1) / kPhotoBlocksPerTask, [&](int64_t task, int) {
    base::ThrowIfCancelled();
    for (int64_t b = task * kPhotoBlocksPerTask; b < std::min(n, (task + 1) * kPhotoBlocksPerTask); ++b) replace(blocks_[static_cast<size_t>(b)]);
  });

  std::vector<int32_t> former;  // views of the cells
  for (const PhotoCell& cell : texture->cells) former.push_back(cell.view);
  MakeCells(layout_, texels_, view, texture);
  TexelColors of_new;
  for (const PhotoCell& cell : texture->cells) {
    const auto found = at.find({cell.chart, cell.y, cell.x});
    if (found == at.end()) {
      of_new.known.push_back(0);
      of_new.rgb_srgb.emplace_back();
      continue;
    }
    const std::vector<int32_t>& here = found->second;
    const auto same = std::find_if(here.begin(), here.end(), [&](int32_t c) { return former[static_cast<size_t>(c)] == cell.view; });
    of_new.known.push_back(1);
    of_new.rgb_srgb.push_back(field->rgb_srgb[static_cast<size_t>(same != here.end() ? *same : here.front())]);
  }
  *field = std::move(of_new);
}

}  // namespace skyquilt::surface
