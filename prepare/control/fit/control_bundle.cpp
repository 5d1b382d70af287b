#include "prepare/control/fit/control_bundle.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "core/base/errors.h"

namespace skyquilt::prepare {
namespace {

struct TrackPixel {
  uint32_t photo = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

BlockLens LensFor(const camera::Camera& camera, bool* known) {
  BlockLens lens;
  lens.camera = camera;
  const std::optional<Lens> numbers = LensOf(camera);
  if (!numbers) {
    *known = false;
    const Eigen::Vector2d middle = camera.PrincipalPoint();
    lens.camera.model = camera::CameraModel::kPinhole;
    lens.camera.params = {camera.FocalX(), camera.FocalY(), middle.x(), middle.y()};
  }
  lens.numbers = lens.initial = numbers ? *numbers : *LensOf(lens.camera);
  lens.unit_px = camera.width / kUnitWidth_px;
  return lens;
}

// Where the block's lens shows what the photo shows at `pixel`.
std::optional<Eigen::Vector2d> PixelInBlock(const camera::Camera& camera, const BlockLens& lens, const Eigen::Vector2d& pixel) {
  if (camera.model == lens.camera.model) return pixel;
  const Eigen::Vector3d ray = camera.RayFromImg(pixel);
  constexpr double kLeastDepth = 0.05;  // flatter rays are far outside of any picture without distortion
  if (!(ray.z() > kLeastDepth)) return std::nullopt;
  return Project(lens.numbers, ray, nullptr);
}

class BlockMaker {
 public:
  explicit BlockMaker(const ControlJob& job) : job_(job) {}

  ControlBlock Make() {
    for (const auto& [id, camera] : job_.model.cameras) {
      lens_of_camera_.emplace(id, static_cast<int>(made_.block.lenses.size()));
      made_.block.lenses.push_back(LensFor(camera, &made_.known_lenses));
    }
    for (const survey::ColmapImage& image : job_.model.images) {
      BlockPhoto photo;
      photo.cam_from_enu = image.cam_from_world.rotation.normalized();
      photo.centre = image.cam_from_world.OriginInSource();
      photo.placed = true;
      photo.lens = lens_of_camera_.at(image.camera_id);
      made_.block.photos.push_back(photo);
    }
    AddTies();
    made_.n_ties = made_.block.tracks.size();
    AddMarks();
    made_.block.agrees.resize(made_.block.tracks.entries.size(), 0);
    made_.block.sigma.assign(made_.block.tracks.entries.size(), 1.0);
    made_.SetAccuracy(1.0, job_.mark_sigma_px);
    return std::move(made_);
  }

 private:
  std::optional<Eigen::Vector2d> PixelOf(uint32_t photo, const Eigen::Vector2d& pixel) const {
    const survey::ColmapImage& image = job_.model.images[photo];
    return PixelInBlock(job_.model.cameras.at(image.camera_id), made_.block.lenses[static_cast<size_t>(made_.block.photos[photo].lens)], pixel);
  }

  void AddTrack(std::vector<TrackPixel>& pixels) {
    for (const TrackPixel& entry : pixels) {
      made_.block.tracks.entries.push_back({entry.photo, 0});
      made_.block.pixel.push_back(entry.pixel);
    }
    made_.block.tracks.first.push_back(static_cast<uint32_t>(made_.block.tracks.entries.size()));
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
      made_.point_of_tie.push_back(i);
      made_.block.point.push_back(job_.model.points[i].x_in_world);
      made_.block.has_point.push_back(1);
    }
    made_.block.agrees.assign(made_.block.tracks.entries.size(), 1);
  }

  void AddMarks() {
    SKYQUILT_CHECK(job_.image_of_station.size() == job_.stations.size(), "one image per station");
    std::map<std::string, uint32_t> photo_of_name;
    for (size_t i = 0; i < job_.stations.size(); ++i) {
      SKYQUILT_CHECK(job_.image_of_station[i] < job_.model.images.size(), job_.stations[i].name);
      photo_of_name.emplace(job_.stations[i].name, static_cast<uint32_t>(job_.image_of_station[i]));
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
        entry_of_mark[mark.index] = static_cast<uint32_t>(made_.block.tracks.entries.size() + pixels.size());
        pixels.push_back(mark.at);
      }
      AddTrack(pixels);
      made_.mark.push_back(std::move(entry_of_mark));
      made_.block.point.push_back(Eigen::Vector3d::Zero());
      made_.block.has_point.push_back(0);
    }
  }

  const ControlJob& job_;
  ControlBlock made_;
  std::map<uint32_t, int> lens_of_camera_;
};

}  // namespace

void ControlBlock::SetAccuracy(double new_tie_sigma, double new_mark_sigma_px) {
  tie_sigma = new_tie_sigma;
  mark_sigma_px = new_mark_sigma_px;
  for (BlockLens& lens : block.lenses) lens.unit_px = tie_sigma * lens.camera.width / kUnitWidth_px;
  for (uint32_t e = block.tracks.first[n_ties]; e < block.tracks.entries.size(); ++e) {
    const BlockPhoto& photo = block.photos[block.tracks.entries[e].photo];
    block.sigma[e] = mark_sigma_px / block.lenses[static_cast<size_t>(photo.lens)].unit_px;
  }
}

double ControlBlock::MarkThreshold(double times) const {
  double unit_px = 0.0;
  for (const BlockLens& lens : block.lenses) unit_px = std::max(unit_px, lens.unit_px);
  return times * std::hypot(mark_sigma_px, unit_px) / unit_px;
}

void ControlBlock::Move(const geo::Similarity3d& b_from_a) {
  for (BlockPhoto& photo : block.photos) {
    photo.centre = b_from_a * photo.centre;
    photo.cam_from_enu = (photo.cam_from_enu * b_from_a.rotation.conjugate()).normalized();
  }
  for (Eigen::Vector3d& point : block.point) point = b_from_a * point;
}

ControlBlock MakeControlBlock(const ControlJob& job) {
  return BlockMaker(job).Make();
}

}  // namespace skyquilt::prepare
