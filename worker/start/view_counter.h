// Counts the photos that show a place without asking every photo: cameras are in a tree by their positions, and of each part of it a sphere around
// the positions and a cone around the directions are known. Parts that cannot show the place are passed over, near ones are asked first.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/camera/camera.h"
#include "core/survey/survey.h"

namespace skyquilt::worker {

class ViewCounter {
 public:
  // Of the training photos among `photos`. `camera_of`: the camera of a photo of the survey, as its pixels are used. Keeps the survey's reference.
  using CameraOf = std::function<const camera::Camera&(int photo)>;
  ViewCounter(const survey::Survey& survey, const std::vector<int>& photos, CameraOf camera_of);

  // Number of photos whose image shows the ball of radius_m metres around x_in_enu, even partly or hidden behind surfaces, as camera::IsVisible has
  // it, and that `shows` accepts, if given. Stops counting at `enough`. Thread-safe.
  using Accept = std::function<bool(int photo)>;
  int Count(const Eigen::Vector3d& x_in_enu, double radius_m, int enough, const Accept& shows = {}) const;

 private:
  struct Node {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the positions' sphere, metres in ENU
    double radius_m = 0.0;
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();  // middle of the directions in which the cameras look
    double half_angle = 0.0;                         // from there to the farthest edge of an image, radians; pi: anything may be in an image
    int first = 0, last = 0;                         // photos_[first, last)
    int left = -1, right = -1;                       // children; -1: a leaf
  };

  int Build(int first, int last);
  bool MayShow(const Node& node, const Eigen::Vector3d& x_in_enu, double radius_m) const;
  void Add(int node, const Eigen::Vector3d& x_in_enu, double radius_m, int enough, const Accept& shows, int* views) const;

  const survey::Survey& survey_;
  CameraOf camera_of_;
  std::vector<int> photos_;     // in the order of the leaves
  std::vector<double> widest_;  // of each photo of the survey: from its axis to the farthest edge, radians
  std::vector<Node> nodes_;
  int root_ = -1;
};

}  // namespace skyquilt::worker
