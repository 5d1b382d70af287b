#include "evaluate/surface/photo_errors.h"

#include <algorithm>

#include "core/base/errors.h"
#include "evaluate/photos/pixel_groups.h"

namespace skyquilt::evaluate::surface {

std::vector<ScoredClass> ScoredClasses() {
  using enum survey::SurfaceClass;
  return {{"roof", {kRoof}}, {"wall", {kWall}}, {"ground", {kGround, kRoad}}, {"road", {kRoad}}, {"tree", {kTree}}};
}

image::Image8 SurfacePhotoErrors::Add(const photos::HeldOutPhoto& task, const photos::PhotoResult& findings, const SurfacePicture& picture) {
  const size_t n_pixels = findings.scored.data.size();
  SKYQUILT_CHECK(picture.colors.size() == n_pixels && picture.has_mesh.size() == n_pixels && task.photo.data.size() == 3 * n_pixels &&
                     findings.render.data.size() == 3 * n_pixels,
                 "photo and pictures must have the same size");
  image::ImageF mesh(task.photo.width, task.photo.height, 3);
  for (size_t i = 0; i < n_pixels; ++i) std::copy_n(picture.colors[i].rgb_srgb, 3, mesh.data.data() + 3 * i);
  image::Image8 shown = image::ToImage8(mesh);

  // Both pictures have 8 bits here, so that neither has an advantage.
  const auto color_at = [](const image::Image8& image, size_t pixel) {
    std::array<float, 3> color{};
    for (size_t c = 0; c < 3; ++c) color[c] = static_cast<float>(image.data[3 * pixel + c]) / 255.0F;
    return color;
  };
  const bool has_classes = findings.true_class.data.size() == n_pixels;
  any_class_ |= has_classes;
  skyquilt::metrics::SquaredError all, with_mesh, field_with_mesh;
  int64_t missing = 0;
  for (size_t i = 0; i < n_pixels; ++i) {
    if (findings.scored.data[i] == 0) continue;
    const std::array<float, 3> photo = color_at(task.photo, i), of_mesh = color_at(shown, i), of_field = color_at(findings.render, i);
    const bool hit = picture.has_mesh[i] != 0;
    photos::AddPixel(of_mesh.data(), photo.data(), &all);
    if (hit) {
      photos::AddPixel(of_mesh.data(), photo.data(), &with_mesh);
      photos::AddPixel(of_field.data(), photo.data(), &field_with_mesh);
    } else {
      ++missing;
    }
    if (!has_classes || findings.true_class.data[i] >= survey::kSurfaceClasses) continue;
    ClassSums& sums = classes_[findings.true_class.data[i]];
    photos::AddPixel(of_mesh.data(), photo.data(), &sums.mesh);
    photos::AddPixel(of_field.data(), photo.data(), &sums.field);
    if (!hit) ++sums.missing;
  }
  pixels_ += photos::PixelsOf(all);
  missing_ += missing;
  psnr_.push_back(skyquilt::metrics::PsnrOf(all));
  psnr_field_.push_back(findings.score.psnr_db);  // the same pixels, and the figure that the report gives elsewhere
  psnr_where_mesh_.push_back(skyquilt::metrics::PsnrOf(with_mesh));
  psnr_field_where_mesh_.push_back(skyquilt::metrics::PsnrOf(field_with_mesh));
  return shown;
}

void SurfacePhotoErrors::Save(base::BytePacker* out) const {
  for (const std::vector<double>* of_photos : {&psnr_, &psnr_field_, &psnr_where_mesh_, &psnr_field_where_mesh_}) out->Add(*of_photos);
  out->Add(pixels_);
  out->Add(missing_);
  out->Add(classes_);
  out->Add(any_class_);
}

void SurfacePhotoErrors::Load(base::ByteUnpacker* in) {
  for (std::vector<double>* of_photos : {&psnr_, &psnr_field_, &psnr_where_mesh_, &psnr_field_where_mesh_}) in->Take(of_photos);
  in->Take(&pixels_);
  in->Take(&missing_);
  in->Take(&classes_);
  in->Take(&any_class_);
}

void SurfacePhotoErrors::Fill(SurfaceScores* scores) const {
  scores->psnr = MeanOfMeasured(psnr_);
  scores->psnr_field = MeanOfMeasured(psnr_field_);
  scores->psnr_where_mesh = MeanOfMeasured(psnr_where_mesh_);
  scores->psnr_field_where_mesh = MeanOfMeasured(psnr_field_where_mesh_);
  scores->pixels = pixels_;
  if (pixels_ > 0) scores->missing_share = static_cast<double>(missing_) / static_cast<double>(pixels_);
  scores->classes.clear();
  if (!any_class_) return;
  for (const ScoredClass& group : ScoredClasses()) {
    ClassSums sums;
    for (const survey::SurfaceClass member : group.members) {
      const ClassSums& one = classes_[static_cast<size_t>(member)];
      sums.mesh += one.mesh;
      sums.field += one.field;
      sums.missing += one.missing;
    }
    SurfaceClassScore& score = scores->classes.emplace_back();
    score.name = group.name;
    score.pixels = photos::PixelsOf(sums.mesh);
    score.missing_pixels = sums.missing;
    score.psnr_db = skyquilt::metrics::PsnrOf(sums.mesh);
    score.psnr_field_db = skyquilt::metrics::PsnrOf(sums.field);
  }
}

}  // namespace skyquilt::evaluate::surface
