#include "simulate/flights/panorama_flight.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/base/file.h"
#include "core/survey/exif.h"
#include "simulate/survey_writer.h"

namespace skyquilt::simulate {

std::vector<PhotoPlan> PlanPanoramas(const std::vector<PhotoPlan>& photos, int n) {
  std::vector<PhotoPlan> places;
  std::copy_if(photos.begin(), photos.end(), std::back_inserter(places), [](const PhotoPlan& photo) { return !photo.oblique; });
  if (places.empty()) places = photos;
  const size_t n_taken = std::min(places.size(), static_cast<size_t>(n));
  std::vector<PhotoPlan> plans;
  for (size_t i = 0; i < n_taken; ++i) {
    PhotoPlan& plan = plans.emplace_back(places[i * places.size() / n_taken]);
    plan.name = fmt::format("PANO_{:04d}.jpg", i + 1);
    plan.pitch_deg = plan.roll_deg = 0.0;
    plan.cam_from_enu = PoseFromGimbal(plan.cam_from_enu.OriginInSource(), plan.yaw_deg, plan.pitch_deg, plan.roll_deg);
  }
  return plans;
}

void WritePanorama(const PhotoPlan& plan, const image::Image8& pixels, const camera::Camera& camera, const geo::EnuFrame& frame, int jpeg_quality,
                   const std::filesystem::path& folder) {
  survey::PhotoTags tags = MakeTags(plan, camera, frame);
  survey::PanoramaTags panorama{
      .heading_deg = {}, .pitch_deg = 0.0, .roll_deg = 0.0, .full_width = pixels.width, .full_height = pixels.height, .area_width = pixels.width};
  if (tags.gimbal_yaw_deg) panorama.heading_deg = *tags.gimbal_yaw_deg < 0.0 ? *tags.gimbal_yaw_deg + 360.0 : *tags.gimbal_yaw_deg;
  tags.panorama = panorama;
  for (std::optional<double>* of_lens :
       {&tags.gimbal_yaw_deg, &tags.gimbal_pitch_deg, &tags.gimbal_roll_deg, &tags.focal_length_mm, &tags.focal_length_35mm}) {
    of_lens->reset();
  }
  image::SaveJpeg(pixels, folder / plan.name, jpeg_quality);
  survey::WritePhotoTags(tags, folder / plan.name);
}

void WritePanoramaPoses(const std::vector<PhotoPlan>& plans, const std::filesystem::path& file) {
  std::string text = "name,rotation_w,rotation_x,rotation_y,rotation_z,translation_x_m,translation_y_m,translation_z_m\n";
  for (const PhotoPlan& plan : plans) {
    const Eigen::Quaterniond& r = plan.cam_from_enu.rotation;
    const Eigen::Vector3d& t = plan.cam_from_enu.translation;
    text += fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f},{:.6f},{:.6f},{:.6f}\n", plan.name, r.w(), r.x(), r.y(), r.z(), t.x(), t.y(), t.z());
  }
  base::WriteFileAtomically(file, text);
}

}  // namespace skyquilt::simulate
