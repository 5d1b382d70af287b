#include "prepare/control/fit/control_bundle.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "core/base/errors.h"

namespace skyquilt::prepare::control {
namespace {

struct TrackPixel {
  uint32_t photo = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

bundle::BundleLens LensFor(const camera::Camera& camera, bool* known) {
  bundle::BundleLens lens;
  lens.camera = camera;
  const std::optional<bundle::Lens> numbers = bundle::LensOf(camera);
  if (!numbers) {
    *known = false;
    const Eigen::Vector2d middle = camera.PrincipalPoint();
    lens.camera.model = camera::CameraModel::kPinhole;
    lens.camera.params = {camera.FocalX(), camera.FocalY(), middle.x(), middle.y()};
  }
  lens.numbers = lens.initial = numbers ? *numbers : *bundle::LensOf(lens.camera);
  lens.unit_px = camera.width / bundle::kUnitWidth_px;
  return lens;
}

// Where the bundle's lens shows what the photo shows at `pixel`.
std::optional<Eigen::Vector2d> PixelInBundle(const camera::Camera& camera, const bundle::BundleLens& lens, const Eigen::Vector2d& pixel) {
  if (camera.model == lens.camera.model) return pixel;
  const Eigen::Vector3d ray = camera.RayFromImg(pixel);
  constexpr double kLeastDepth = 0.05;  // flatter rays are far outside of any picture without distortion
  if (!(ray.z() > kLeastDepth)) return std::nullopt;
  return bundle::Project(lens.numbers, ray, nullptr);
}

class BundleBuilder {
 public:
  explicit BundleBuilder(const ControlJob& job) : job_(job) {}

  ControlBundle Build() {
    for (const auto& [id, camera] : job_.model.cameras) {
      lens_of_camera_.emplace(id, static_cast<int>(result_.bundle.lenses.size()));
      result_.bundle.lenses.push_back(LensFor(camera, &result_.known_lenses));
      result_.bundle.lenses.back().exact = job_.model.exact_cameras.contains(id);
    }
    for (const survey::ColmapImage& image : job_.model.images) {
      bundle::BundlePhoto photo;
      photo.cam_from_enu = image.cam_from_world.rotation.normalized();
      photo.centre = image.cam_from_world.OriginInSource();
      photo.placed = true;
      photo.lens = lens_of_camera_.at(image.camera_id);
      photo.shot = image.shot;
      photo.cam_from_rig = image.cam_from_rig;
      result_.bundle.photos.push_back(photo);
    }
    AddTies();
    result_.n_ties = result_.bundle.tracks.size();
    AddMarks();
    result_.bundle.agrees.resize(result_.bundle.tracks.entries.size(), 0);
    result_.bundle.sigma.assign(result_.bundle.tracks.entries.size(), 1.0);
    result_.SetAccuracy(1.0, job_.mark_sigma_px);
    return std::move(result_);
  }

 private:
  std::optional<Eigen::Vector2d> PixelOf(uint32_t photo, const Eigen::Vector2d& pixel) const {
    const survey::ColmapImage& image = job_.model.images[photo];
    return PixelInBundle(job_.model.cameras.at(image.camera_id), result_.bundle.lenses[static_cast<size_t>(result_.bundle.photos[photo].lens)],
                         pixel);
  }

  void AddTrack(std::vector<TrackPixel>& pixels) {
    for (const TrackPixel& entry : pixels) {
      result_.bundle.tracks.entries.push_back({entry.photo, 0});
      result_.bundle.pixel.push_back(entry.pixel);
    }
    result_.bundle.tracks.first.push_back(static_cast<uint32_t>(result_.bundle.tracks.entries.size()));
  }

  void AddTies() {
    std::unordered_map<uint64_t, size_t> index;
    for (size_t i = 0; i < job_.model.points.size(); ++i) index.emplace(job_.model.points[i].id, i);
    std::vector<std::vector<TrackPixel>> seen(job_.model.points.size());
    for (uint32_t photo = 0; photo < job_.model.images.size(); ++photo) {
      const auto of_image = job_.observations.find(job_.model.images[photo].id);
      if (of_image == job_.observations.end()) continue;
      for (const survey::ColmapObservation& observation : of_image->second) {
        const auto point = index.find(observation.point_id);
        if (point == index.end()) continue;
        std::vector<TrackPixel>& track = seen[point->second];
        if (!track.empty() && track.back().photo == photo) continue;  // a point twice in one photo: one of them is wrong
        if (const auto pixel = PixelOf(photo, observation.pixel)) track.push_back({photo, *pixel});
      }
    }
    for (size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].size() < 2) continue;
      AddTrack(seen[i]);
      result_.point_of_tie.push_back(i);
      result_.bundle.point.push_back(job_.model.points[i].x_in_world);
      result_.bundle.has_point.push_back(1);
    }
    result_.bundle.agrees.assign(result_.bundle.tracks.entries.size(), 1);
  }

  void AddMarks() {
    std::map<std::string, uint32_t> photo_of_name;
    for (const input::PreparedPhoto& photo : job_.photos) {
      SKYQUILT_CHECK(photo.image < job_.model.images.size(), photo.file.name);
      photo_of_name.emplace(photo.file.name, static_cast<uint32_t>(photo.image));
    }
    for (const ControlPoint& point : job_.control.points) {
      struct Mark {
        TrackPixel at;
        size_t index;
      };
      std::vector<Mark> marks;
      for (size_t k = 0; k < point.marks.size(); ++k) {
        const auto photo = photo_of_name.find(point.marks[k].photo);
        if (photo == photo_of_name.end()) continue;
        if (const auto pixel = PixelOf(photo->second, point.marks[k].pixel)) marks.push_back({{photo->second, *pixel}, k});
      }
      std::stable_sort(marks.begin(), marks.end(), [](const Mark& a, const Mark& b) { return a.at.photo < b.at.photo; });
      std::vector<std::optional<uint32_t>> entry_of_mark(point.marks.size());
      std::vector<TrackPixel> pixels;
      for (const Mark& mark : marks) {
        entry_of_mark[mark.index] = static_cast<uint32_t>(result_.bundle.tracks.entries.size() + pixels.size());
        pixels.push_back(mark.at);
      }
      AddTrack(pixels);
      result_.mark.push_back(std::move(entry_of_mark));
      result_.bundle.point.push_back(Eigen::Vector3d::Zero());
      result_.bundle.has_point.push_back(0);
    }
  }

  const ControlJob& job_;
  ControlBundle result_;
  std::map<uint32_t, int> lens_of_camera_;
};

}  // namespace

void ControlBundle::SetAccuracy(double new_tie_sigma, double new_mark_sigma_px) {
  tie_sigma = new_tie_sigma;
  mark_sigma_px = new_mark_sigma_px;
  for (bundle::BundleLens& lens : bundle.lenses) lens.unit_px = tie_sigma * lens.camera.width / bundle::kUnitWidth_px;
  for (uint32_t e = bundle.tracks.first[n_ties]; e < bundle.tracks.entries.size(); ++e) {
    const bundle::BundlePhoto& photo = bundle.photos[bundle.tracks.entries[e].photo];
    bundle.sigma[e] = mark_sigma_px / bundle.lenses[static_cast<size_t>(photo.lens)].unit_px;
  }
}

double ControlBundle::MarkThreshold(double times) const {
  double unit_px = 0.0;
  for (const bundle::BundleLens& lens : bundle.lenses) unit_px = std::max(unit_px, lens.unit_px);
  return times * std::hypot(mark_sigma_px, unit_px) / unit_px;
}

void ControlBundle::Move(const geo::Similarity3d& b_from_a) {
  for (bundle::BundlePhoto& photo : bundle.photos) {
    photo.centre = b_from_a * photo.centre;
    photo.cam_from_enu = (photo.cam_from_enu * b_from_a.rotation.conjugate()).normalized();
    photo.cam_from_rig.translation *= b_from_a.scale;
  }
  for (Eigen::Vector3d& point : bundle.point) point = b_from_a * point;
}

ControlBundle MakeControlBundle(const ControlJob& job) {
  return BundleBuilder(job).Build();
}

}  // namespace skyquilt::prepare::control
