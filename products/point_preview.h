// The first picture of a survey: its photos laid on the surface between its sparse points. It needs no field, so it is there seconds after the poses.
#pragma once

#include <filesystem>

#include "core/base/thread_pool.h"
#include "core/survey/survey.h"
#include "products/preview_files.h"
#include "products/product_options.h"

namespace skyquilt::products {

struct PointPreview {
  std::filesystem::path picture;  // the .png
  gis::MapGrid grid;
  double filled = 0.0;  // share of the cells with data, 0..1
  int photos = 0;       // shown
  int unreadable = 0;
};

// At most this many cells, and pixels of photos at full size; of more photos an even choice is read.
constexpr double kMostPreviewCells = 2e6;
constexpr double kMostPhotoPixels = 3e9;

// Writes the preview (products/preview_files.h) into `folder`, which is created; it replaces any other. Held-out photos are used too: nothing is
// learnt from the picture. Photos that cannot be read are left out with a warning. options.boundary limits the map. The same bytes for any number of
// threads. Without geo-reference the map is in the local frame. Throws base::InputError when there are no sparse points, no photo that looks down on
// the ground or none that can be read, or a file cannot be written; base::UsageError as BoundaryOf; base::Interrupted.
PointPreview MakePointPreview(const survey::Survey& survey, const ProductOptions& options, const std::filesystem::path& folder,
                              base::ThreadPool& threads);

}  // namespace skyquilt::products
