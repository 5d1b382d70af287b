#include "prepare/rigs/view_files.h"

#include <algorithm>

#include "core/base/cancel.h"
#include "core/base/output_file.h"
#include "prepare/input/masks/mask_files.h"

namespace skyquilt::prepare::rigs {
namespace {

namespace fs = std::filesystem;

constexpr int kJpegQuality = 95;

double MaskedShare(const image::Image8& mask) {
  if (mask.Empty()) return 0.0;
  return static_cast<double>(std::count(mask.data.begin(), mask.data.end(), 0)) / static_cast<double>(mask.data.size());
}

// Hidden until it is complete, so that what a killed process leaves is no photo.
void WritePicture(const image::Image8& pixels, const survey::PhotoTags& tags, const fs::path& file) {
  base::PartialPath partial(file, file.parent_path() / ("." + file.filename().string()));
  image::SaveJpeg(pixels, partial.path(), kJpegQuality);
  survey::WritePhotoTags(tags, partial.path());
  partial.Publish();
}

}  // namespace

void WriteViews(const PanoramaJob& job, const std::vector<PanoramaView>& views, double nadir_deg, const ViewFolders& folders,
                std::map<std::string, double>* masked, base::ThreadPool& threads) {
  image::Image8 picture, own_mask;
  if (!job.photo.mask.empty()) own_mask = input::LoadMaskAt(job.photo.mask, job.photo.width, job.photo.height);
  for (size_t i = 0; i < views.size(); ++i) {
    base::ThrowIfCancelled();
    const fs::path file = folders.pictures / job.names[i], mask_file = folders.masks / (job.names[i] + ".png");
    const image::Image8 mask = MaskOfView(own_mask, job.area, job.camera, views[i].cam_from_pano, nadir_deg, threads);
    const double share = MaskedShare(mask);
    (*masked)[job.names[i]] = share;
    if (share > kMostMasked || fs::exists(file)) continue;
    if (!mask.Empty()) {
      fs::create_directories(mask_file.parent_path());
      image::SavePng(mask, mask_file);
    }
    if (picture.Empty()) picture = image::LoadRgb8(folders.panoramas / job.photo.name);
    fs::create_directories(file.parent_path());
    WritePicture(RenderView(picture, job.area, job.camera, views[i].cam_from_pano, threads),
                 TagsOfView(job.photo.tags, views[i], job.camera.width, job.camera.FocalX()), file);
  }
}

}  // namespace skyquilt::prepare::rigs
