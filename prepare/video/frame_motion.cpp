#include "prepare/video/frame_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace skyquilt::prepare::video {
namespace {

constexpr int kMostCorners = 48, kPatch = 15, kSearch = 6;
constexpr double kLeastCorrelation = 0.7;
constexpr int kFewestAgreeing = 8;
constexpr double kLeastAgreeingShare = 0.4;
// Of the width: farther shifts are not looked for.
constexpr double kFarthest = 0.4;
// Roofs move faster than the ground below them: points agree when they are within so much of their shift.
constexpr double kAgree_px = 1.5, kAgreeShare = 0.12;

cv::Mat View(const image::Image8& image) {
  // OpenCV has no read-only pictures.
  return {image.height, image.width, CV_8UC1, const_cast<uint8_t*>(image.data.data())};
}

struct Match {
  double from_x, from_y, to_x, to_y;  // pixels from the middle
};

// In pixels from the middle.
struct PixelShift {
  double a = 1.0, b = 0.0, x = 0.0, y = 0.0;
  double ErrorOf(const Match& m) const { return std::hypot(a * m.from_x - b * m.from_y + x - m.to_x, b * m.from_x + a * m.from_y + y - m.to_y); }
  bool Explains(const Match& m) const { return ErrorOf(m) <= kAgree_px + kAgreeShare * std::hypot(m.to_x - m.from_x, m.to_y - m.from_y); }
};

PixelShift ThroughTwo(const Match& p, const Match& q) {
  const double fx = q.from_x - p.from_x, fy = q.from_y - p.from_y, tx = q.to_x - p.to_x, ty = q.to_y - p.to_y;
  const double length2 = fx * fx + fy * fy;
  PixelShift shift;
  shift.a = (fx * tx + fy * ty) / length2;
  shift.b = (fx * ty - fy * tx) / length2;
  shift.x = p.to_x - (shift.a * p.from_x - shift.b * p.from_y);
  shift.y = p.to_y - (shift.b * p.from_x + shift.a * p.from_y);
  return shift;
}

// Least squares.
PixelShift ThroughAll(const std::vector<Match>& matches) {
  const auto n = static_cast<double>(matches.size());
  double fx = 0.0, fy = 0.0, tx = 0.0, ty = 0.0;
  for (const Match& m : matches) {
    fx += m.from_x / n;
    fy += m.from_y / n;
    tx += m.to_x / n;
    ty += m.to_y / n;
  }
  double length2 = 0.0, cosine = 0.0, sine = 0.0;
  for (const Match& m : matches) {
    const double ax = m.from_x - fx, ay = m.from_y - fy, bx = m.to_x - tx, by = m.to_y - ty;
    length2 += ax * ax + ay * ay;
    cosine += ax * bx + ay * by;
    sine += ax * by - ay * bx;
  }
  PixelShift shift;
  if (length2 > 0.0) {
    shift.a = cosine / length2;
    shift.b = sine / length2;
  }
  shift.x = tx - (shift.a * fx - shift.b * fy);
  shift.y = ty - (shift.b * fx + shift.a * fy);
  return shift;
}

// The shift that explains most matches: all pairs are tried, which are few.
std::vector<Match> LargestAgreement(const std::vector<Match>& matches) {
  constexpr double kLeastApart_px = 20.0, kLargestScale = 1.6;
  std::vector<Match> best;
  size_t n_best = 0;
  PixelShift best_shift;
  for (size_t i = 0; i < matches.size(); ++i) {
    for (size_t j = i + 1; j < matches.size(); ++j) {
      if (std::hypot(matches[i].from_x - matches[j].from_x, matches[i].from_y - matches[j].from_y) < kLeastApart_px) continue;
      const PixelShift shift = ThroughTwo(matches[i], matches[j]);
      const double scale = std::hypot(shift.a, shift.b);
      if (!(scale < kLargestScale && scale > 1.0 / kLargestScale)) continue;
      const auto n = static_cast<size_t>(std::count_if(matches.begin(), matches.end(), [&](const Match& m) { return shift.Explains(m); }));
      if (n <= n_best) continue;
      n_best = n;
      best_shift = shift;
    }
  }
  if (n_best > 0) std::copy_if(matches.begin(), matches.end(), std::back_inserter(best), [&](const Match& m) { return best_shift.Explains(m); });
  return best;
}

// Position of the best match within a pixel, by a parabola through three correlations.
double Peak(double before, double at, double after) {
  const double curve = before - 2.0 * at + after;
  return curve < 0.0 ? std::clamp(0.5 * (before - after) / curve, -0.5, 0.5) : 0.0;
}

image::Image8 Small(const image::Image8& grey) {
  if (grey.width <= FrameTracker::kWidth) return grey;
  return image::Resize(grey, FrameTracker::kWidth, image::ScaledHeight(grey.width, grey.height, FrameTracker::kWidth));
}

// The shift of the whole picture; poor where it turns.
PixelShift WholeShift(const cv::Mat& before, const cv::Mat& after) {
  cv::Mat a, b, window;
  before.convertTo(a, CV_32F);
  after.convertTo(b, CV_32F);
  cv::createHanningWindow(window, a.size(), CV_32F);
  const cv::Point2d shift = cv::phaseCorrelate(a, b, window);
  return {.x = shift.x, .y = shift.y};
}

}  // namespace

FrameShift FrameShift::Then(const FrameShift& next) const {
  return {.a = next.a * a - next.b * b,
          .b = next.b * a + next.a * b,
          .right = next.a * right - next.b * down + next.right,
          .down = next.b * right + next.a * down + next.down};
}

FrameShift FrameShift::Inverse() const {
  const double scale2 = a * a + b * b;
  const FrameShift turned{.a = a / scale2, .b = -b / scale2};
  return {.a = turned.a, .b = turned.b, .right = -(turned.a * right - turned.b * down), .down = -(turned.b * right + turned.a * down)};
}

double NewShare(const FrameShift& shift, double aspect) {
  double moved = 0.0;
  for (const auto& [x, y] : std::array<std::pair<double, double>, 4>{{{-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}}}) {
    const double down = aspect * y;
    const double to_right = shift.a * x - shift.b * down + shift.right, to_down = shift.b * x + shift.a * down + shift.down;
    moved += 0.25 * (std::abs(to_right - x) + std::abs(to_down - down) / aspect);
  }
  return moved;
}

std::optional<TrackedShift> FrameTracker::Track(const image::Image8& grey) {
  image::Image8 now = Small(grey);
  std::optional<TrackedShift> tracked;
  const cv::Mat after = View(now);
  if (!before_.Empty() && before_.width == now.width && before_.height == now.height && HasCorners()) {
    const cv::Mat before = View(before_);
    const double middle_x = 0.5 * (now.width - 1), middle_y = 0.5 * (now.height - 1);
    const PixelShift steady{.a = last_.a, .b = last_.b, .x = last_.right * now.width, .y = last_.down * now.width};
    for (const PixelShift& guess : {WholeShift(before, after), steady, PixelShift{}}) {
      std::vector<Match> matches;
      for (const Point& corner : corners_) {
        const double x = static_cast<double>(corner.x) - middle_x, y = static_cast<double>(corner.y) - middle_y;
        const int half = kPatch / 2;
        const int from_x = static_cast<int>(std::lround(corner.x)), from_y = static_cast<int>(std::lround(corner.y));
        const int to_x = static_cast<int>(std::lround(guess.a * x - guess.b * y + guess.x + middle_x));
        const int to_y = static_cast<int>(std::lround(guess.b * x + guess.a * y + guess.y + middle_y));
        const cv::Rect frame(0, 0, now.width, now.height);
        const cv::Rect patch(from_x - half, from_y - half, kPatch, kPatch);
        const cv::Rect area(to_x - half - kSearch, to_y - half - kSearch, kPatch + 2 * kSearch, kPatch + 2 * kSearch);
        if ((patch & frame) != patch || (area & frame) != area) continue;
        cv::Mat scores;
        cv::matchTemplate(after(area), before(patch), scores, cv::TM_CCOEFF_NORMED);
        cv::Point best;
        double score = 0.0;
        cv::minMaxLoc(scores, nullptr, &score, nullptr, &best);
        const bool inside = best.x > 0 && best.y > 0 && best.x < scores.cols - 1 && best.y < scores.rows - 1;
        if (!inside || !(score >= kLeastCorrelation)) continue;
        const auto at = [&scores, &best](int dx, int dy) { return static_cast<double>(scores.at<float>(best.y + dy, best.x + dx)); };
        const double sub_x = Peak(at(-1, 0), at(0, 0), at(1, 0));
        const double sub_y = Peak(at(0, -1), at(0, 0), at(0, 1));
        const double found_x = area.x + half + best.x + sub_x, found_y = area.y + half + best.y + sub_y;
        matches.push_back({from_x - middle_x, from_y - middle_y, found_x - middle_x, found_y - middle_y});
      }
      const std::vector<Match> agreeing = LargestAgreement(matches);
      const auto n = static_cast<int>(agreeing.size());
      const bool enough = n >= kFewestAgreeing && n >= kLeastAgreeingShare * static_cast<double>(matches.size());
      if (!enough || (tracked && n <= tracked->n_agreeing)) continue;
      const PixelShift shift = ThroughAll(agreeing);
      const double width = now.width;
      if (std::hypot(shift.x, shift.y) > kFarthest * width) continue;
      tracked = TrackedShift{{.a = shift.a, .b = shift.b, .right = shift.x / width, .down = shift.y / width}, static_cast<int>(corners_.size()), n};
      // Most of them: no other guess finds more.
      if (2 * n > static_cast<int>(corners_.size())) break;
    }
  }
  last_ = tracked ? tracked->shift : FrameShift();
  std::vector<cv::Point2f> found;
  cv::goodFeaturesToTrack(after, found, kMostCorners, 0.02, 6.0);
  corners_.clear();
  for (const cv::Point2f& point : found) corners_.push_back({point.x, point.y});
  before_ = std::move(now);
  return tracked;
}

double SharpnessOf(const image::Image8& grey) {
  if (grey.width < 3 || grey.height < 3) return 0.0;
  cv::Mat edges;
  cv::Laplacian(View(grey), edges, CV_32F);
  cv::Scalar mean, deviation;
  cv::meanStdDev(edges, mean, deviation);
  return deviation[0] * deviation[0];
}

}  // namespace skyquilt::prepare::video
