// Compares pictures of the mesh, and beside them those of the field, with held-out photos.
#pragma once

#include <array>
#include <vector>

#include "core/base/packed_bytes.h"
#include "core/metrics/psnr.h"
#include "core/survey/surface_class.h"
#include "evaluate/photos/photo_scorer.h"
#include "evaluate/surface/mesh_picture.h"
#include "evaluate/surface/surface_scores.h"

namespace skyquilt::evaluate::surface {

// The classes that are scored, in order: name and members.
struct ScoredClass {
  const char* name;
  std::vector<survey::SurfaceClass> members;
};
std::vector<ScoredClass> ScoredClasses();

class SurfacePhotoErrors {
 public:
  // Adds the scored pixels of a photo. findings: result of ScorePhoto for this task. picture: of the mesh, at the photo's brightness. Returns the
  // picture with 8 bits.
  image::Image8 Add(const photos::HeldOutPhoto& task, const photos::PhotoResult& findings, const SurfacePicture& picture);
  // Sets the figures of pictures; classes only if a photo had true classes, then one per ScoredClasses().
  void Fill(SurfaceScores* scores) const;
  // All that was added, so that others can go on from here.
  void Save(base::BytePacker* out) const;
  void Load(base::ByteUnpacker* in);
  size_t n_photos() const { return psnr_.size(); }

 private:
  struct ClassSums {
    skyquilt::metrics::SquaredError mesh, field;
    int64_t missing = 0;
  };
  std::vector<double> psnr_, psnr_field_, psnr_where_mesh_, psnr_field_where_mesh_;  // of the photos
  int64_t pixels_ = 0, missing_ = 0;
  std::array<ClassSums, survey::kSurfaceClasses> classes_;
  bool any_class_ = false;
};

}  // namespace skyquilt::evaluate::surface
