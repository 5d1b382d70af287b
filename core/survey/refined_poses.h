// Poses of training photos that were refined while a field was trained (worker/poses/pose_learner.h), as small changes of the survey's own. They are
// kept beside the survey, in refined/: poses.json, which this program reads, and sparse/, a COLMAP model (text) of the refined poses in ENU
// metres, for other programs. Held-out photos, and the survey's own files, stay as they are.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::survey {

// The change of a camera's pose, in the axes of the camera as given (x right, y down, z forward): enu_from_cam = (R, c) becomes
// (R exp(rotation), c + R translation).
struct PoseOffset {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();     // radians, a vector along its axis
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // metres
};

geo::Rigid3d WithOffset(const geo::Rigid3d& enu_from_cam, const PoseOffset& offset);
PoseOffset OffsetBetween(const geo::Rigid3d& given, const geo::Rigid3d& changed);

struct RefinedPoses {
  struct Photo {
    std::string name;
    PoseOffset offset;
    double moved_px = 0.0;  // root mean square by which places in the photo moved, pixels of the photo as trained
  };
  std::vector<Photo> photos;  // those that were refined, in the survey's order

  // For people: "poses of 57 photos refined: median 3.1 cm, 0.12 degrees, 0.6 pixels; largest 9.7 cm, ...".
  std::string Summary() const;
};

// Median and largest of the offsets.
struct OffsetSizes {
  double median_m = 0.0, largest_m = 0.0;
  double median_deg = 0.0, largest_deg = 0.0;
  double median_px = 0.0, largest_px = 0.0;
};
OffsetSizes SizesOf(const RefinedPoses& poses);

// Moves the photos that are named, but held-out ones. Names that the survey does not have are ignored.
void ApplyRefinedPoses(const RefinedPoses& poses, Survey& survey);

std::filesystem::path RefinedPosesFolder(const std::filesystem::path& survey_folder);
// `survey`: as given. Throws base::InputError when the folder cannot be written.
void SaveRefinedPoses(const RefinedPoses& poses, const Survey& survey, const std::filesystem::path& survey_folder);
// Nothing when there are none. Throws base::InputError for a damaged file.
std::optional<RefinedPoses> LoadRefinedPoses(const std::filesystem::path& survey_folder);
void RemoveRefinedPoses(const std::filesystem::path& survey_folder);

// LoadSurvey, with refined poses where there are some: for all that is made with training photos after the fields were trained.
Survey LoadRefinedSurvey(const std::filesystem::path& survey_folder);

}  // namespace skyquilt::survey
