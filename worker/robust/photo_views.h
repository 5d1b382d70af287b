// What each training photo shows and how far away it is, so that a place can be looked up in all of them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/render/ray.h"
#include "core/survey/survey.h"
#include "worker/rays/ray_source.h"
#include "worker/robust/cell_picture.h"

namespace skyquilt::worker {

// Renders any number of rays (ENU, metres); both spans have the same length. May throw base::Interrupted.
using DepthCaster = std::function<void(std::span<const render::Ray>, std::span<render::RayColor>)>;

struct PhotoView {
  CellPicture picture;              // empty: a held-out photo, which nothing may be learned from
  Eigen::Vector3d eye, axis;        // ENU; the axis has length 1
  int depth_columns = 0;            // distances are known at nodes, kDepthCells cells apart
  std::vector<float> distance_m{};  // along the rays of the nodes, row by row; NaN: no surface
};

// How a photo shows a place, beside another photo's cell there.
struct PlaceSighting {
  std::array<float, 3> rgb{};  // display values at reference exposure
  // Differences of display values, the largest over the channels; a cell's width of misplacement makes none:
  float own = 0.0F;    // of the other photo's cell from the range of colours around the place in this photo
  float place = 0.0F;  // of the place in this photo from the range of colours around the other photo's cell
};

class PhotoViews {
 public:
  // All must outlive it. cell_px: side of a cell, pixels of the cached photos. Throws base::Interrupted and what the caster throws.
  PhotoViews(const survey::Survey& survey, const image::PixelCache& pixels, const RaySource& source, const brightness::Response& response,
             int cell_px, const DepthCaster& caster, base::ThreadPool& threads);

  size_t size() const { return views_.size(); }
  const PhotoView& operator[](size_t photo) const { return views_[photo]; }
  // Distance to the surface along the ray through a position in the cached photo; NaN where none is known.
  double DistanceAt(size_t photo, const Eigen::Vector2d& pixel) const;
  // How a photo shows a place in ENU, beside a cell of another photo (its colour and the range around it). With `visible` the place must be on the
  // surface that the photo shows. Nothing when the photo does not show it, or shows it at its rim, masked or too bright.
  std::optional<PlaceSighting> Look(size_t photo, const Eigen::Vector3d& place, const CellPicture::Cell& cell, const CellPicture::Range& around,
                                    bool visible) const;

 private:
  void MeasureDistances(size_t photo, const DepthCaster& caster);

  const survey::Survey& survey_;
  const RaySource& source_;
  int cell_px_;
  std::vector<PhotoView> views_;
};

}  // namespace skyquilt::worker
