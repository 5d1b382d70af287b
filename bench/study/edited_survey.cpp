#include "bench/study/edited_survey.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "bench/study/thin_survey.h"
#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/base/random.h"
#include "core/camera/camera.h"
#include "core/image/image.h"
#include "core/image/srgb.h"

namespace skyquilt::bench {
namespace {

constexpr double kWaterShare = 0.6;  // of the survey's width
constexpr float kGlints = 0.04F;     // share of the water's pixels
constexpr int kEveryBlack = 4;

using PhotoEdit = std::function<void(const survey::Photo& photo, image::Image8& picture)>;

// Writes the photos for which `edit` returns true and links the others.
void EditPhotos(survey::Survey& survey, const std::filesystem::path& folder, const std::function<bool(const survey::Photo&, int)>& wanted,
                const PhotoEdit& edit) {
  int training = 0;
  for (const survey::Photo& photo : survey.photos) {
    const int index = photo.is_test ? -1 : training++;
    const std::filesystem::path to = folder / photo.name;
    std::filesystem::create_directories(to.parent_path());
    std::filesystem::remove(to);
    if (!wanted(photo, index)) {
      std::filesystem::create_symlink(std::filesystem::absolute(survey.photo_root / photo.name), to);
      continue;
    }
    image::Image8 picture = image::LoadRgb8(survey.photo_root / photo.name);
    edit(photo, picture);
    image::SavePng(picture, to);
  }
  survey.photo_root = std::filesystem::absolute(folder);
}

double GroundHeight(const survey::Survey& survey) {
  std::vector<double> heights;
  for (const survey::SparsePoint& point : survey.points) heights.push_back(point.x_in_enu.z());
  if (heights.empty()) throw base::UsageError("a survey without sparse points has no ground to edit");
  return base::Median(std::move(heights));
}

void AddWater(survey::Survey& survey, const std::filesystem::path& folder) {
  const double ground_m = GroundHeight(survey);
  std::vector<double> east;
  for (const survey::SparsePoint& point : survey.points) east.push_back(point.x_in_enu.x());
  const double shore_m = base::Quantile(std::move(east), kWaterShare);
  const auto all = [](const survey::Photo&, int) { return true; };
  EditPhotos(survey, folder, all, [&](const survey::Photo& photo, image::Image8& picture) {
    const camera::Camera camera = survey.cameras[static_cast<size_t>(photo.camera)].Resized(picture.width, picture.height);
    const geo::Rigid3d enu_from_cam = photo.cam_from_enu.Inverse();
    base::Random glints(std::hash<std::string>()(photo.name));
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const Eigen::Vector3d direction = enu_from_cam.rotation * camera.RayFromImg({x + 0.5, y + 0.5});
        const double along = (ground_m - enu_from_cam.translation.z()) / direction.z();
        if (direction.z() >= 0.0 || enu_from_cam.translation.x() + along * direction.x() > shore_m) continue;
        const bool glint = glints.Uniform() < kGlints;
        uint8_t* pixel = picture.At(x, y);
        pixel[0] = glint ? 255 : 0;
        pixel[1] = glint ? 255 : 12;
        pixel[2] = 255;
      }
    }
  });
}

void MakeBright(image::Image8& picture) {
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      uint8_t* pixel = picture.At(x, y);
      for (int c = 0; c < 3; ++c) {
        const float light = 10.0F * image::LinearFromSrgb(static_cast<float>(pixel[c]) / 255.0F);
        pixel[c] = static_cast<uint8_t>(std::lround(255.0F * std::clamp(image::SrgbFromLinear(light), 0.0F, 1.0F)));
      }
    }
  }
}

// Ground sampling distance of the photos at full size, metres.
double Gsd(const survey::Survey& survey) {
  const double agl_m = survey.MedianAgl();
  if (!(agl_m > 0.0)) throw base::UsageError("a survey whose photos have no height above ground cannot be scaled to a ground sampling distance");
  return camera::GroundSamplingDistance(survey.cameras[static_cast<size_t>(survey.photos.front().camera)], agl_m);
}

void Scale(survey::Survey& survey, double factor) {
  for (survey::Photo& photo : survey.photos) {
    photo.cam_from_enu.translation *= factor;
    photo.agl_m *= factor;
    photo.gps.reset();
  }
  for (auto* points : {&survey.points, &survey.kept_points}) {
    for (survey::SparsePoint& point : *points) point.x_in_enu *= factor;
  }
}

// The training photo in the middle of the flight, and those taken closest to it.
void KeepThree(survey::Survey& survey) {
  std::vector<size_t> training;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    if (!survey.photos[i].is_test) training.push_back(i);
  }
  if (training.size() <= 3) return;
  const Eigen::Vector3d centre = survey.photos[training[training.size() / 2]].cam_from_enu.OriginInSource();
  const auto distance = [&](size_t i) { return (survey.photos[i].cam_from_enu.OriginInSource() - centre).norm(); };
  std::partial_sort(training.begin(), training.begin() + 3, training.end(), [&](size_t a, size_t b) { return distance(a) < distance(b); });
  std::vector<bool> keep;
  keep.reserve(survey.photos.size());
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    keep.push_back(survey.photos[i].is_test || std::find(training.begin(), training.begin() + 3, i) != training.begin() + 3);
  }
  KeepPhotos(survey, keep);
}

}  // namespace

const std::vector<NamedEdit>& SurveyEdits() {
  static const std::vector<NamedEdit> edits = {{SurveyEdit::kBrightPhoto, "bright-photo", "one photo ten times brighter"},
                                               {SurveyEdit::kBlackPhotos, "black-photos", "every fourth photo black"},
                                               {SurveyEdit::kWater, "water", "saturated water in most of the picture"},
                                               {SurveyEdit::kThreePhotos, "three-photos", "three training photos"},
                                               {SurveyEdit::kMillimetres, "gsd-1mm", "pixels of 1 mm"},
                                               {SurveyEdit::kTenMetres, "gsd-10m", "pixels of 10 m"},
                                               {SurveyEdit::kZoneEdge, "zone-edge", "at 180 degrees east"}};
  return edits;
}

survey::Survey EditSurvey(survey::Survey survey, SurveyEdit edit, const std::filesystem::path& folder) {
  survey.truth.reset();
  switch (edit) {
    case SurveyEdit::kNone:
      break;
    case SurveyEdit::kBrightPhoto: {
      const auto middle = std::count_if(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& photo) { return !photo.is_test; }) / 2;
      EditPhotos(
          survey, folder, [middle](const survey::Photo&, int index) { return index == middle; },
          [](const survey::Photo&, image::Image8& picture) { MakeBright(picture); });
      break;
    }
    case SurveyEdit::kBlackPhotos:
      EditPhotos(
          survey, folder, [](const survey::Photo&, int index) { return index >= 0 && index % kEveryBlack == 0; },
          [](const survey::Photo&, image::Image8& picture) { picture = image::Image8(picture.width, picture.height, 3); });
      break;
    case SurveyEdit::kWater:
      AddWater(survey, folder);
      break;
    case SurveyEdit::kThreePhotos:
      KeepThree(survey);
      break;
    case SurveyEdit::kMillimetres:
      Scale(survey, 0.001 / Gsd(survey));
      break;
    case SurveyEdit::kTenMetres:
      Scale(survey, 10.0 / Gsd(survey));
      break;
    case SurveyEdit::kZoneEdge:
      survey.origin.longitude_deg = 180.0;
      for (survey::Photo& photo : survey.photos) photo.gps.reset();
      break;
  }
  return survey;
}

}  // namespace skyquilt::bench
