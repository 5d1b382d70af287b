// Colours of texels from photos, which are sharper than a field of limited size.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/survey/photo_pictures.h"
#include "surface/texture/texel_colors.h"
#include "surface/texture/view_choice.h"

namespace skyquilt::surface {

// Texels that one photo colours in a square of 4 x 4 texels of a chart. The field is asked for one colour in each.
struct PhotoCell {
  int32_t view = -1;
  uint32_t chart = 0;
  int x = 0, y = 0;     // of the square in its chart
  uint32_t middle = 0;  // the texel nearest to the middle of the square
  uint32_t texels = 0;
  std::array<float, 3> light = {};  // mean of the photo, linear
};
constexpr int kPhotoCellTexels = 4;

struct PhotoTexture {
  std::vector<int32_t> cell;                   // per texel; -1: no photo shows it
  std::vector<std::array<float, 3>> rgb_srgb;  // per texel, as the photo shows it
  std::vector<PhotoCell> cells;                // chart by chart
};

// Per view the median of the field's light over its photo's, in this tile; 1 where there is too little to compare. field: of the cells.
std::vector<std::array<float, 3>> GainsOfViews(size_t views, const PhotoTexture& texture, const TexelColors& field);

// Reads the photos of a tile. What it refers to must outlive it.
class TexturePhotos {
 public:
  // tolerance_m: see Sees.
  TexturePhotos(const TileGeometry& geometry, const AtlasLayout& layout, const AtlasTexels& texels, std::span<const TexelBlock> blocks,
                std::span<const DepthView> views, const survey::Survey& survey, survey::PhotoPictures& photos, double tolerance_m)
      : geometry_(geometry),
        layout_(layout),
        texels_(texels),
        blocks_(blocks),
        views_(views),
        survey_(survey),
        photos_(photos),
        tolerance_m_(tolerance_m) {}

  // Each texel from the first of its block's photos that sees it clearly, at less than 75 degrees from its normal, and does not hide it by a mask.
  // Photos that are held out are never read. Same bits for any number of threads.
  PhotoTexture Colors(base::ThreadPool& threads) const;

  // Photos also show what moved. Cells whose photo differs from the field's colour get the next photo of their block that does not, or none.
  // field: of the cells, in their order; that of the new cells afterwards.
  void ReplaceStrangers(base::ThreadPool& threads, PhotoTexture* texture, TexelColors* field) const;

 private:
  struct ViewPicture;
  ViewPicture PictureOf(int32_t view) const;
  // Nothing when the view's photo does not show the texel.
  std::optional<std::array<float, 3>> ColorAt(const ViewPicture& picture, uint32_t texel) const;
  // What the view's photo shows of a cell's texels, if it shows most of them and its mean, times the gain, is near the field's colour; otherwise
  // empty.
  std::vector<std::optional<std::array<float, 3>>> ColorsAgreeing(int32_t view, std::span<const uint32_t> cell, const std::array<float, 3>& gain,
                                                                  const std::array<float, 3>& field_srgb) const;

  const TileGeometry& geometry_;
  const AtlasLayout& layout_;
  const AtlasTexels& texels_;
  std::span<const TexelBlock> blocks_;
  std::span<const DepthView> views_;
  const survey::Survey& survey_;
  survey::PhotoPictures& photos_;
  double tolerance_m_;
};

}  // namespace skyquilt::surface
