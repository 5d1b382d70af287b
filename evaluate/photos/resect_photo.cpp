#include "evaluate/photos/resect_photo.h"

#include <algorithm>
#include <cmath>

#include "core/geo/pose_gauge.h"
#include "core/linear/linear.h"
#include "core/metrics/psnr.h"
#include "evaluate/photos/alternate_tiles.h"

namespace skyquilt::evaluate::photos {
namespace {

constexpr int kFitWidth = 400;  // pixels of the reduced picture; narrower photos are not reduced
constexpr int kRounds = 5;
constexpr double kStepPx = 0.3;  // of finite differences, reduced pixels
constexpr double kLargestStepPx = 3.0;
constexpr double kDamping = 1e-3;      // of the normal equations, relative to their diagonal
constexpr double kLargestError = 0.1;  // display values: larger differences, such as of what moved, count as this much (Huber 1964)

using Vector6 = Eigen::Matrix<double, 6, 1>;

float Shown(float value) {
  return std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 0.0F;
}

struct FittedPixel {
  size_t index;  // in the reduced picture
  float wanted[3];
};

std::vector<FittedPixel> PixelsToFit(const HeldOutPhoto& task, const image::Image8& scored, const camera::Camera& small) {
  const image::Image8 reduced = small.width == task.photo.width ? task.photo : image::Resize(task.photo, small.width, small.height);
  std::vector<FittedPixel> pixels;
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      const int full_x = std::min(static_cast<int>((x + 0.5) * scored.width / small.width), scored.width - 1);
      const int full_y = std::min(static_cast<int>((y + 0.5) * scored.height / small.height), scored.height - 1);
      if (*scored.At(full_x, full_y) == 0 || !IsFittedTile(full_x, full_y)) continue;
      FittedPixel pixel{static_cast<size_t>(y) * static_cast<size_t>(small.width) + static_cast<size_t>(x), {}};
      for (int c = 0; c < 3; ++c) pixel.wanted[c] = static_cast<float>(reduced.At(x, y)[c]) / 255.0F;
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

// Weights of residuals, and their robust sum.
double Cost(const std::vector<FittedPixel>& pixels, const std::vector<render::RayColor>& rendered) {
  double cost = 0.0;
  for (const FittedPixel& pixel : pixels) {
    for (size_t c = 0; c < 3; ++c) {
      const double error = std::abs(static_cast<double>(Shown(rendered[pixel.index].rgb_srgb[c]) - pixel.wanted[c]));
      cost += error <= kLargestError ? error * error : kLargestError * (2.0 * error - kLargestError);
    }
  }
  return cost;
}

double PsnrOnOtherTiles(const HeldOutPhoto& task, const image::Image8& scored, std::span<const render::RayColor> rendered) {
  skyquilt::metrics::SquaredError error;
  for (int y = 0; y < scored.height; ++y) {
    for (int x = 0; x < scored.width; ++x) {
      if (*scored.At(x, y) == 0 || IsFittedTile(x, y)) continue;
      const render::RayColor& ray = rendered[static_cast<size_t>(y) * static_cast<size_t>(scored.width) + static_cast<size_t>(x)];
      float made[3], wanted[3];
      for (int c = 0; c < 3; ++c) {
        made[c] = Shown(ray.rgb_srgb[c]);
        wanted[c] = static_cast<float>(task.photo.At(x, y)[c]) / 255.0F;
      }
      AddPixel(made, wanted, &error);
    }
  }
  return skyquilt::metrics::PsnrOf(error);
}

}  // namespace

ResectedPhoto ResectPhoto(const HeldOutPhoto& task, const image::Image8& scored, std::span<const render::RayColor> as_given, double distance_m,
                          const PhotoRenderer& render) {
  ResectedPhoto result;
  result.given_db = PsnrOnOtherTiles(task, scored, as_given);
  const int width = std::min(kFitWidth, task.camera.width);
  const camera::Camera small =
      width == task.camera.width ? task.camera : task.camera.Resized(width, image::ScaledHeight(task.camera.width, task.camera.height, width));
  const std::vector<FittedPixel> pixels = PixelsToFit(task, scored, small);
  if (pixels.size() < 100 || std::isnan(result.given_db)) return result;
  const geo::Rigid3d given = task.cam_from_enu.Inverse();
  const auto pose_at = [&given](const Vector6& x) { return survey::WithOffset(given, {x.head<3>(), x.tail<3>()}).Inverse(); };
  // Units of the parameters that move the picture by about a reduced pixel.
  Vector6 unit;
  const double turn = 1.0 / small.FocalX();
  unit << turn, turn, 2.0 * small.FocalX() / small.width * turn, distance_m * turn, distance_m * turn,
      2.0 * small.FocalX() / small.width * distance_m * turn;
  Vector6 x = Vector6::Zero();
  std::vector<render::RayColor> now = render(small, pose_at(x));
  double cost = Cost(pixels, now);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::vector<render::RayColor>> moved;
    moved.reserve(6);
    for (int i = 0; i < 6; ++i) moved.push_back(render(small, pose_at(x + kStepPx * unit.cwiseProduct(Vector6::Unit(i)))));
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(6, 6);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(6);
    for (const FittedPixel& pixel : pixels) {
      for (size_t c = 0; c < 3; ++c) {
        const float shown = Shown(now[pixel.index].rgb_srgb[c]);
        const double error = static_cast<double>(pixel.wanted[c] - shown);
        const double weight = std::abs(error) <= kLargestError ? 1.0 : kLargestError / std::abs(error);
        Vector6 slope;
        for (size_t i = 0; i < 6; ++i)
          slope[static_cast<Eigen::Index>(i)] = static_cast<double>(Shown(moved[i][pixel.index].rgb_srgb[c]) - shown) / kStepPx;
        normal += weight * slope * slope.transpose();
        right += weight * error * slope;
      }
    }
    normal.diagonal() *= 1.0 + kDamping;
    normal.diagonal().array() += 1e-12;
    Eigen::VectorXd step = linear::SolvePositive(normal, right);
    if (!step.allFinite()) break;
    step *= std::min(1.0, kLargestStepPx / std::max(1e-12, step.cwiseAbs().maxCoeff()));
    // Halved until it helps.
    bool better = false;
    for (int half = 0; half < 3 && !better; ++half, step *= 0.5) {
      const Vector6 next = x + unit.cwiseProduct(step);
      std::vector<render::RayColor> there = render(small, pose_at(next));
      const double cost_there = Cost(pixels, there);
      if (!(cost_there < cost)) continue;
      better = true;
      x = next;
      cost = cost_there;
      now = std::move(there);
    }
    if (!better || step.cwiseAbs().maxCoeff() < 0.01) break;
  }
  result.offset = {x.head<3>(), x.tail<3>()};
  // Where the offset moves the middle of the pixels' cones at that distance.
  double squares = 0.0;
  int places = 0;
  for (size_t k = 0; k < pixels.size(); k += 1 + pixels.size() / 500) {
    const auto at = static_cast<int>(pixels[k].index);
    const int row = at / small.width;
    const Eigen::Vector2d pixel(at % small.width + 0.5, row + 0.5);
    const Eigen::Vector3d place = distance_m * small.RayFromImg(pixel);
    const auto there = small.ImgFromCam(geo::RotationOfVector(-result.offset.rotation) * (place - result.offset.translation));
    if (!there) continue;
    squares += (*there - pixel).squaredNorm();
    ++places;
  }
  if (places > 0) result.moved_px = std::sqrt(squares / places) * task.camera.width / small.width;
  result.resected_db = PsnrOnOtherTiles(task, scored, render(task.camera, pose_at(x)));
  return result;
}

}  // namespace skyquilt::evaluate::photos
