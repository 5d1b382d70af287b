#include "buildings/pictures/model_view.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>

#include "buildings/classes/solid_edges.h"
#include "buildings/pictures/solid_rays.h"

namespace skyquilt::buildings {
namespace {

constexpr double kFlat_rad = 1.0 * std::numbers::pi / 180.0;  // edges of faces that meet at less are not drawn
constexpr double kStep_px = 2.0;
constexpr int kMostSteps = 4000;

class Viewer {
 public:
  Viewer(const Solid& solid, const camera::Camera& camera, const geo::Rigid3d& cam_from_enu)
      : solid_(solid), camera_(camera), cam_from_enu_(cam_from_enu), eye_(cam_from_enu.OriginInSource()), rays_(solid) {
    for (const Face& face : solid.face) {
      const Eigen::Vector3d normal = NormalOf(solid, face);
      faces_camera_.push_back(normal.dot(eye_ - solid.vertex[face.outer[0]]) > 0.0);
    }
  }

  void View(const SolidEdge& edge, std::vector<ViewedPiece>* pieces) const {
    const Eigen::Vector3d &from = solid_.vertex[edge.from], &to = solid_.vertex[edge.to];
    const bool roof = IsRoof(edge.face) || IsRoof(edge.other);
    const bool faces_away = !FacesCamera(edge.face) && !FacesCamera(edge.other);
    const int steps = StepsOf(from, to);
    bool begun = false;  // the last piece goes on
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector3d x = from + (static_cast<double>(i) / steps) * (to - from);
      const std::optional<Eigen::Vector2d> pixel = camera_.ImgFromCam(cam_from_enu_ * x);
      if (!pixel) {
        begun = false;
        continue;
      }
      // The ends touch faces of other edges, so that the inside of the edge decides there.
      const Eigen::Vector3d inside = from + std::clamp(static_cast<double>(i) / steps, 0.01, 0.99) * (to - from);
      const bool hidden = faces_away || IsCovered(inside, edge);
      if (begun && pieces->back().hidden == hidden) {
        pieces->back().points.push_back(*pixel);
        continue;
      }
      // Without a gap between a visible piece and the hidden one that follows.
      std::vector<Eigen::Vector2d> points;
      if (begun) points.push_back(pieces->back().points.back());
      points.push_back(*pixel);
      pieces->push_back({std::move(points), hidden, roof});
      begun = true;
    }
  }

 private:
  bool IsRoof(int face) const { return face >= 0 && solid_.face[static_cast<size_t>(face)].kind == FaceKind::kRoof; }
  bool FacesCamera(int face) const { return face >= 0 && faces_camera_[static_cast<size_t>(face)]; }

  // By the length in the image without distortion, which bends but hardly stretches.
  int StepsOf(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
    const Eigen::Vector3d a = cam_from_enu_ * from, b = cam_from_enu_ * to;
    const double nearest = std::max(std::min(a.z(), b.z()), 0.01);
    const double pixels = (b - a).norm() / nearest * std::max(camera_.FocalX(), camera_.FocalY());
    return std::clamp(static_cast<int>(std::min(pixels / kStep_px, 1.0 * kMostSteps)), 4, kMostSteps);
  }

  // The faces of the edge itself never cover it: where it bounds them it is on their border.
  bool IsCovered(const Eigen::Vector3d& x, const SolidEdge& edge) const {
    const Eigen::Vector3d direction = x - eye_;
    const double slack = std::min(0.01, 0.02 / std::max(direction.norm(), 1e-9));  // two centimetres as a share of the ray
    return rays_.FirstHit(eye_, direction, edge.face, edge.other) < 1.0 - slack;
  }

  const Solid& solid_;
  const camera::Camera& camera_;
  const geo::Rigid3d& cam_from_enu_;
  Eigen::Vector3d eye_;
  std::vector<bool> faces_camera_;
  SolidRays rays_;
};

bool IsDrawn(const SolidEdge& edge) {
  return edge.angle_rad > kFlat_rad;
}

}  // namespace

std::vector<ViewedPiece> ViewEdges(const Solid& solid, const camera::Camera& camera, const geo::Rigid3d& cam_from_enu) {
  std::vector<ViewedPiece> pieces;
  if (solid.Empty()) return pieces;
  const Viewer viewer(solid, camera, cam_from_enu);
  for (const SolidEdge& edge : EdgesOf(solid))
    if (IsDrawn(edge)) viewer.View(edge, &pieces);
  std::erase_if(pieces, [](const ViewedPiece& piece) { return piece.points.size() < 2; });
  return pieces;
}

std::vector<Eigen::Vector3d> PlacesOnEdges(const Solid& solid) {
  constexpr int kPieces = 4;
  std::vector<Eigen::Vector3d> places = solid.vertex;
  for (const SolidEdge& edge : EdgesOf(solid)) {
    for (int i = 1; i < kPieces; ++i)
      places.push_back(solid.vertex[edge.from] + (1.0 * i / kPieces) * (solid.vertex[edge.to] - solid.vertex[edge.from]));
  }
  return places;
}

}  // namespace skyquilt::buildings
