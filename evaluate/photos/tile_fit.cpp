#include "evaluate/photos/tile_fit.h"

#include <algorithm>
#include <cmath>

#include "core/brightness/exposure.h"
#include "core/linear/linear.h"
#include "evaluate/photos/alternate_tiles.h"
#include "evaluate/photos/pixel_groups.h"

namespace skyquilt::evaluate::photos {
namespace {

constexpr int kTileFitSteps = 10;
constexpr float kWhite = 254.5F / 255.0F, kNearlyBlack = 0.5F / 255.0F;
// So many neighbouring pixels err together.
constexpr double kPixelsTogether = 100.0;
constexpr double kWeakGain = 1e-6;  // damping of gains, as a number of pixels: a photo may have no usable pixel

class TileFit {
 public:
  TileFit(const image::ImageF& render, const image::ImageF& photo, const image::Image8& scored, const brightness::ShadingGrid& grid, double sigma,
          bool shades)
      : render_(render), photo_(photo), scored_(scored), grid_(grid), sigma_(sigma), knots_(shades ? grid.knots() : 0) {
    at_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 + knots_));
    for (int step = 0; step < kTileFitSteps; ++step) {
      if (Step() < 1e-4) break;
    }
  }

  brightness::Exposure ExposureAt(int x, int y, size_t colour) const {
    double log_gain = at_[static_cast<Eigen::Index>(colour)];
    if (knots_ > 0) {
      const brightness::KnotWeights around = Around(x, y);
      for (size_t i = 0; i < 4; ++i) log_gain += static_cast<double>(around.weight[i]) * at_[static_cast<Eigen::Index>(3 + around.knot[i])];
    }
    return brightness::Exposure::FromLogGain(static_cast<float>(log_gain));
  }
  const Eigen::VectorXd& parameters() const { return at_; }

 private:
  brightness::KnotWeights Around(int x, int y) const {
    return brightness::KnotsAt(grid_, {(static_cast<float>(x) + 0.5F) / static_cast<float>(photo_.width),
                                       (static_cast<float>(y) + 0.5F) / static_cast<float>(photo_.height)});
  }

  // One step of Gauss and Newton; returns the largest change.
  double Step() {
    const Eigen::Index n = at_.size();
    Eigen::MatrixXd left = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    double squares = 0.0, values = 0.0;
    for (int y = 0; y < photo_.height; ++y) {
      for (int x = 0; x < photo_.width; ++x) {
        if (*scored_.At(x, y) == 0 || !IsFittedTile(x, y)) continue;
        const brightness::KnotWeights around = knots_ > 0 ? Around(x, y) : brightness::KnotWeights{};
        for (size_t c = 0; c < 3; ++c) {
          const float wanted = photo_.At(x, y)[c];
          if (wanted >= kWhite || wanted <= kNearlyBlack) continue;
          const brightness::Exposed exposed = brightness::Expose(render_.At(x, y)[c], ExposureAt(x, y, c));
          const auto slope = static_cast<double>(exposed.log_gain_slope), off = static_cast<double>(exposed.value - wanted);
          squares += off * off;
          values += 1.0;
          Add(static_cast<Eigen::Index>(c), slope, off, around, left, right);
        }
      }
    }
    if (values == 0.0) return 0.0;
    AddPrior(std::max(squares / values, 1e-6) * kPixelsTogether / (sigma_ * sigma_), left, right);
    const Eigen::VectorXd change = linear::SolvePositive(left, right);
    double largest = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double limited = std::clamp(change[i], -1.0, 1.0);
      at_[i] -= limited;
      largest = std::max(largest, std::abs(limited));
    }
    return largest;
  }

  void Add(Eigen::Index colour, double slope, double off, const brightness::KnotWeights& around, Eigen::MatrixXd& left,
           Eigen::VectorXd& right) const {
    left(colour, colour) += slope * slope;
    right[colour] += slope * off;
    for (size_t i = 0; i < 4 && knots_ > 0; ++i) {
      const auto k = static_cast<Eigen::Index>(3 + around.knot[i]);
      const double slope_k = slope * static_cast<double>(around.weight[i]);
      right[k] += slope_k * off;
      left(k, colour) += slope_k * slope;
      left(colour, k) += slope_k * slope;
      for (size_t j = 0; j < 4; ++j)
        left(k, static_cast<Eigen::Index>(3 + around.knot[j])) += slope_k * slope * static_cast<double>(around.weight[j]);
    }
  }

  void AddPrior(double strength, Eigen::MatrixXd& left, Eigen::VectorXd& right) const {
    for (Eigen::Index c = 0; c < 3; ++c) left(c, c) += kWeakGain;
    if (knots_ == 0) return;
    std::vector<double> gradient(knots_, 0.0), unit(knots_, 0.0);
    brightness::AddShadingPrior(grid_, std::span<const double>(at_.data() + 3, knots_), strength, gradient);
    for (size_t k = 0; k < knots_; ++k) {
      right[static_cast<Eigen::Index>(3 + k)] += gradient[k];
      std::vector<double> column(knots_, 0.0);
      unit[k] = 1.0;
      brightness::AddShadingPrior(grid_, std::span<const double>(unit), strength, column);
      unit[k] = 0.0;
      for (size_t l = 0; l < knots_; ++l) left(static_cast<Eigen::Index>(3 + l), static_cast<Eigen::Index>(3 + k)) += column[l];
    }
  }

  const image::ImageF& render_;
  const image::ImageF& photo_;
  const image::Image8& scored_;
  const brightness::ShadingGrid& grid_;
  double sigma_;
  size_t knots_;
  Eigen::VectorXd at_;  // log gains of red, green and blue, then knots
};

}  // namespace

TileScores ScoreAlternateTiles(const image::ImageF& render, const image::ImageF& photo, const image::Image8& scored,
                               const brightness::ShadingGrid& grid, double sigma) {
  const TileFit gains(render, photo, scored, grid, sigma, false), shaded(render, photo, scored, grid, sigma, true);
  TileScores scores;
  for (int y = 0; y < photo.height; ++y) {
    for (int x = 0; x < photo.width; ++x) {
      if (*scored.At(x, y) == 0 || IsFittedTile(x, y)) continue;
      const auto add = [&](const TileFit* fit, skyquilt::metrics::SquaredError* error) {
        float shown[3];
        for (size_t c = 0; c < 3; ++c) {
          const float value = render.At(x, y)[c];
          shown[c] = std::clamp(fit == nullptr ? value : brightness::Expose(value, fit->ExposureAt(x, y, c)).value, 0.0F, 1.0F);
        }
        AddPixel(shown, photo.At(x, y), error);
      };
      add(nullptr, &scores.rendered);
      add(&gains, &scores.gains);
      add(&shaded, &scores.shaded);
    }
  }
  for (size_t c = 0; c < 3; ++c) scores.log_gain[c] = static_cast<float>(shaded.parameters()[static_cast<Eigen::Index>(c)]);
  for (size_t k = 0; k < grid.knots(); ++k) scores.log_shading.push_back(static_cast<float>(shaded.parameters()[static_cast<Eigen::Index>(3 + k)]));
  return scores;
}

}  // namespace skyquilt::evaluate::photos
