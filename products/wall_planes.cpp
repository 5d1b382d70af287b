#include "products/wall_planes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/order_statistics.h"
#include "core/base/random.h"

namespace skyquilt::products {
namespace {

constexpr double kWallBand = 0.01;         // of the viewing distance, to each side of a plane
constexpr double kWallSurroundings = 3.0;  // bands to each side, in which points count against it
constexpr double kWallGap = 20.0;          // bands without points end a wall
constexpr double kSmallestWall = 8.0;      // bands, width and height
constexpr double kWallRim = 0.02;          // of width and height, added on each side
constexpr double kWallStrays = 0.01;       // of the points, beyond each side
constexpr size_t kFewestWallPoints = 30;
constexpr double kShareOnWall = 0.6;  // of the points in its surroundings; where points are everywhere it is a third
constexpr double kSmallestShare = 0.1;
constexpr double kLowColumn = 0.3;  // of the height of a wall: columns that rise less are not part of it
constexpr int kHypotheses = 800, kTestedHypotheses = 40;
constexpr size_t kScoredPoints = 8000, kDistancePoints = 2000, kWallRounds = 8;

struct PlanLine {
  Eigen::Vector2d point, along;  // along: length 1
  Eigen::Vector2d Across() const { return {-along.y(), along.x()}; }
  double Distance(const Eigen::Vector3d& x) const { return std::abs(Across().dot(x.head<2>() - point)); }
  double Along(const Eigen::Vector3d& x) const { return along.dot(x.head<2>() - point); }
};

struct Range {
  double low = 0.0, high = 0.0;
  bool Contains(double x) const { return x >= low && x <= high; }
  double Length() const { return high - low; }
};

struct FoundWall {
  PlanLine line;
  Range along, z;
  std::vector<size_t> points;  // indices into Survey::points
  bool Covers(const Eigen::Vector3d& x, double reach_m) const {
    return line.Distance(x) <= reach_m && along.Contains(line.Along(x)) && z.Contains(x.z());
  }
};

// Indices of points that at least three photos saw, or of all where these are few.
std::vector<size_t> SteadyIndices(const survey::Survey& survey) {
  std::vector<size_t> all, steady;
  for (size_t i = 0; i < survey.points.size(); ++i) {
    if (!survey.points[i].x_in_enu.allFinite()) continue;
    all.push_back(i);
    if (survey.points[i].track_length >= 3) steady.push_back(i);
  }
  return steady.size() >= std::max(kFewestWallPoints, all.size() / 4) ? steady : all;
}

// Total least squares in plan.
PlanLine FitLine(const survey::Survey& survey, const std::vector<size_t>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const size_t i : points) mean += survey.points[i].x_in_enu.head<2>();
  mean /= static_cast<double>(points.size());
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const size_t i : points) {
    const Eigen::Vector2d off = survey.points[i].x_in_enu.head<2>() - mean;
    xx += off.x() * off.x();
    xy += off.x() * off.y();
    yy += off.y() * off.y();
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return {mean, {std::cos(angle), std::sin(angle)}};
}

template <typename Value>
Range RobustRange(const std::vector<size_t>& points, double strays, const Value& value) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const size_t i : points) values.push_back(value(i));
  const double low = base::NearestRankQuantile(values, strays);
  return {low, base::NearestRankQuantile(values, 1.0 - strays)};
}

class WallFinder {
 public:
  WallFinder(const survey::Survey& survey, double distance_m) : survey_(survey), band_m_(kWallBand * distance_m), left_(SteadyIndices(survey)) {}

  std::vector<FoundWall> Find() {
    std::vector<FoundWall> walls;
    while (walls.size() < kWallRounds && left_.size() >= kFewestWallPoints) {
      std::optional<FoundWall> wall = Next();
      if (!wall) break;
      std::erase_if(left_, [&](size_t i) { return wall->Covers(At(i), kWallSurroundings * band_m_); });
      walls.push_back(*std::move(wall));
    }
    return walls;
  }

 private:
  const Eigen::Vector3d& At(size_t point) const { return survey_.points[point].x_in_enu; }

  std::optional<PlanLine> Hypothesis(int number) {
    const Eigen::Vector2d first = At(left_[random_.Below(static_cast<uint32_t>(left_.size()))]).head<2>();
    const std::vector<survey::YawMode>& modes = survey_.directions.modes;
    if (number % 2 == 0 && !modes.empty()) {
      const uint32_t choice = random_.Below(static_cast<uint32_t>(2 * modes.size()));
      const double yaw = (modes[choice / 2].yaw_deg + (choice % 2 == 0 ? 0.0 : 90.0)) * std::numbers::pi / 180.0;
      return PlanLine{first, {std::cos(yaw), std::sin(yaw)}};
    }
    const Eigen::Vector2d way = At(left_[random_.Below(static_cast<uint32_t>(left_.size()))]).head<2>() - first;
    if (!(way.norm() > kSmallestWall * band_m_)) return std::nullopt;
    return PlanLine{first, way.normalized()};
  }

  // Points on the plane against those beside it: 0 where points are everywhere alike.
  double Score(const PlanLine& line) const {
    const size_t step = std::max<size_t>(1, left_.size() / kScoredPoints);
    double score = 0.0;
    for (size_t k = 0; k < left_.size(); k += step) {
      const double distance = line.Distance(At(left_[k]));
      if (distance <= band_m_) {
        score += 1.0;
      } else if (distance <= kWallSurroundings * band_m_) {
        score -= 1.0 / (kWallSurroundings - 1.0);
      }
    }
    return score;
  }

  std::optional<FoundWall> Next() {
    std::vector<std::pair<double, PlanLine>> scored;
    for (int i = 0; i < kHypotheses; ++i) {
      if (const std::optional<PlanLine> line = Hypothesis(i)) scored.emplace_back(Score(*line), *line);
    }
    std::stable_sort(scored.begin(), scored.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    if (scored.size() > kTestedHypotheses) scored.resize(kTestedHypotheses);
    for (const auto& [score, line] : scored) {
      if (std::optional<FoundWall> wall = Test(line)) return wall;
    }
    return std::nullopt;
  }

  // The longest stretch of points on the plane; nothing when it is no wall.
  std::optional<FoundWall> Test(PlanLine line) const {
    FoundWall wall;
    for (int round = 0; round < 4; ++round) {
      wall.line = line;
      wall.points = Stretch(line, PointsOn(line));
      if (wall.points.size() < kFewestWallPoints) return std::nullopt;
      line = FitLine(survey_, wall.points);
    }
    const auto along = [&](size_t i) { return wall.line.Along(At(i)); };
    const auto z = [&](size_t i) { return At(i).z(); };
    KeepStanding(RobustRange(wall.points, kWallStrays, z).Length(), &wall);
    if (wall.points.size() < kFewestWallPoints) return std::nullopt;
    wall.along = RobustRange(wall.points, kWallStrays, along);
    wall.z = RobustRange(wall.points, kWallStrays, z);
    if (!(std::min(wall.along.Length(), wall.z.Length()) >= kSmallestWall * band_m_)) return std::nullopt;
    size_t on = 0, around = 0;
    for (const size_t i : left_) {
      if (!wall.Covers(At(i), kWallSurroundings * band_m_)) continue;
      ++around;
      if (wall.line.Distance(At(i)) <= band_m_) ++on;
    }
    if (static_cast<double>(on) < kShareOnWall * static_cast<double>(around)) return std::nullopt;
    return wall;
  }

  std::vector<size_t> PointsOn(const PlanLine& line) const {
    std::vector<size_t> points;
    for (const size_t i : left_) {
      if (line.Distance(At(i)) <= band_m_) points.push_back(i);
    }
    return points;
  }

  // The most points without a gap.
  std::vector<size_t> Stretch(const PlanLine& line, const std::vector<size_t>& points) const {
    std::vector<std::pair<double, size_t>> on;
    for (const size_t i : points) on.emplace_back(line.Along(At(i)), i);
    std::sort(on.begin(), on.end());
    size_t best_begin = 0, best_end = 0;
    for (size_t begin = 0; begin < on.size();) {
      size_t end = begin + 1;
      while (end < on.size() && on[end].first - on[end - 1].first <= kWallGap * band_m_) ++end;
      if (end - begin > best_end - best_begin) {
        best_begin = begin;
        best_end = end;
      }
      begin = end;
    }
    std::vector<size_t> stretch;
    for (size_t k = best_begin; k < best_end; ++k) stretch.push_back(on[k].second);
    return stretch;
  }

  // Takes away ground in the same plane beyond the ends of the wall: columns of points that do not rise.
  void KeepStanding(double height_m, FoundWall* wall) const {
    const auto column = [&](size_t i) { return static_cast<int64_t>(std::floor(wall->line.Along(At(i)) / (kSmallestWall * band_m_))); };
    std::map<int64_t, Range> columns;
    for (const size_t i : wall->points) {
      const double z = At(i).z();
      Range& range = columns.try_emplace(column(i), Range{z, z}).first->second;
      range = {std::min(range.low, z), std::max(range.high, z)};
    }
    std::erase_if(wall->points, [&](size_t i) { return columns.at(column(i)).Length() < kLowColumn * height_m; });
    wall->points = Stretch(wall->line, wall->points);
  }

  const survey::Survey& survey_;
  double band_m_;
  std::vector<size_t> left_;
  base::Random random_{58};
};

// Whether the photos that see the wall stand on the side to which `normal` points, the straighter they see it the more they count: those that
// observed its points, or where that is not known all that look towards it.
bool PhotosStandThere(const survey::Survey& survey, const FoundWall& wall, const Eigen::Vector3d& middle, const Eigen::Vector3d& normal) {
  double there = 0.0, behind = 0.0;
  const auto count = [&](const survey::Photo& photo, const Eigen::Vector3d& x) {
    if (photo.is_test) return;
    const double cosine = (photo.cam_from_enu.OriginInSource() - x).normalized().dot(normal);
    (cosine > 0.0 ? there : behind) += cosine * cosine;
  };
  if (!survey.tracks.Empty()) {
    for (const size_t i : wall.points) {
      for (const int32_t photo : survey.tracks.PhotosOf(i)) count(survey.photos[static_cast<size_t>(photo)], survey.points[i].x_in_enu);
    }
  }
  if (there + behind == 0.0) {
    for (const survey::Photo& photo : survey.photos) {
      if ((photo.cam_from_enu * middle).z() > 0.0) count(photo, middle);
    }
  }
  return there >= behind;
}

Wall RectangleOf(const survey::Survey& survey, const FoundWall& found) {
  Wall wall;
  const double along = 0.5 * (found.along.low + found.along.high);
  wall.middle_enu << found.line.point + along * found.line.along, 0.5 * (found.z.low + found.z.high);
  wall.normal_enu << found.line.Across(), 0.0;
  if (!PhotosStandThere(survey, found, wall.middle_enu, wall.normal_enu)) wall.normal_enu = -wall.normal_enu;
  wall.width_m = (1.0 + 2.0 * kWallRim) * found.along.Length();
  wall.height_m = (1.0 + 2.0 * kWallRim) * found.z.Length();
  wall.points = found.points.size();
  return wall;
}

}  // namespace

double ViewingDistance(const survey::Survey& survey) {
  std::vector<Eigen::Vector3d> eyes;
  for (const survey::Photo& photo : survey.photos) eyes.push_back(photo.cam_from_enu.OriginInSource());
  std::vector<double> distances;
  const size_t step = std::max<size_t>(1, survey.points.size() / kDistancePoints);
  for (size_t i = 0; i < survey.points.size(); i += step) {
    const Eigen::Vector3d& x = survey.points[i].x_in_enu;
    if (!x.allFinite()) continue;
    if (!survey.tracks.Empty()) {
      for (const int32_t photo : survey.tracks.PhotosOf(i)) {
        if (!survey.photos[static_cast<size_t>(photo)].is_test) distances.push_back((eyes[static_cast<size_t>(photo)] - x).norm());
      }
      continue;
    }
    // From the nearest that looks towards it.
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t photo = 0; photo < eyes.size(); ++photo) {
      const survey::Photo& one = survey.photos[photo];
      if (!one.is_test && (one.cam_from_enu * x).z() > 0.0) nearest = std::min(nearest, (eyes[photo] - x).norm());
    }
    if (std::isfinite(nearest)) distances.push_back(nearest);
  }
  return base::Median(std::move(distances));
}

std::vector<Wall> FindWalls(const survey::Survey& survey, size_t most) {
  std::vector<Wall> walls;
  const double distance_m = ViewingDistance(survey);
  if (!(distance_m > 0.0)) return walls;
  for (const FoundWall& found : WallFinder(survey, distance_m).Find()) walls.push_back(RectangleOf(survey, found));
  const auto area = [](const Wall& wall) { return wall.width_m * wall.height_m; };
  std::stable_sort(walls.begin(), walls.end(), [&](const Wall& a, const Wall& b) { return area(a) > area(b); });
  if (!walls.empty()) {
    const double smallest = kSmallestShare * area(walls.front());
    std::erase_if(walls, [&](const Wall& wall) { return area(wall) < smallest; });
  }
  if (walls.size() > most) walls.resize(most);
  return walls;
}

}  // namespace skyquilt::products
