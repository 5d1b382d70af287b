#include "prepare/bundle/adjustment_accuracy.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "core/linear/linear.h"
#include "core/linear/sparse.h"
#include "prepare/bundle/entry_term.h"

namespace skyquilt::prepare::bundle {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
// Of the unknowns of a photo or a lens, without memory of its own.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 16, 16>;

// Two products compiled once: those of other types, or by Eigen's blocked algorithm, take seconds to compile and are no faster at these sizes.
SmallMatrix Times(const SmallMatrix& a, const SmallMatrix& b) {
  return a.lazyProduct(b);
}

// weight a^T b
SmallMatrix Weighted(double weight, const SmallMatrix& a, const SmallMatrix& b) {
  return weight * a.transpose().lazyProduct(b);
}

double HuberWeight(double norm, double limit) {
  return norm <= limit ? 1.0 : limit / norm;
}

double CauchyWeight(double norm, double scale) {
  return 1.0 / (1.0 + norm * norm / (scale * scale));
}

// Information on a point, and its products with the unknowns of photos and lenses.
struct PointTerms {
  Matrix3d information = Matrix3d::Zero();
  std::vector<std::pair<int, SmallMatrix>> products;  // per group of unknowns
  int entries = 0;

  void Add(int group, const SmallMatrix& product) {
    for (auto& [known, sum] : products) {
      if (known != group) continue;
      sum += product;
      return;
    }
    products.emplace_back(group, product);
  }
};

}  // namespace

struct AdjustmentAccuracy::Impl {
  const BundleProblem& bundle;
  std::vector<uint32_t> tracks;
  BundleStage stage;
  std::vector<int> group_of_photo, group_of_lens, first;  // first: unknown of each group, and their number
  std::vector<std::vector<int>> free_of_lens;             // numbers of each lens
  int shift_group = -1;
  std::unordered_map<uint64_t, MatrixXd> blocks;  // lower triangle, by groups
  Eigen::VectorXd scale;                          // of the unknowns, so that all have the same accuracy without the others
  std::optional<linear::SparseFactors> factors;
  bool ok = false;

  explicit Impl(const BundleProblem& of) : bundle(of) {}

  void AddBlock(int row, int col, const SmallMatrix& value) {
    const bool lower = row >= col;
    const auto a = static_cast<uint64_t>(lower ? row : col), b = static_cast<uint64_t>(lower ? col : row);
    const auto [found, is_new] = blocks.try_emplace(a * first.size() + b);
    if (is_new) found->second.setZero(lower ? value.rows() : value.cols(), lower ? value.cols() : value.rows());
    if (lower) {
      found->second += value;
    } else {
      found->second += value.transpose();
    }
  }

  double WeightOf(const EntryTerm& term) const {
    const double norm = term.residual.norm();
    return stage.gentle ? HuberWeight(norm, stage.loss) : CauchyWeight(norm, stage.loss);
  }

  SmallMatrix FreePart(const EntryTerm& term, int lens) const {
    const std::vector<int>& columns = free_of_lens[static_cast<size_t>(lens)];
    SmallMatrix part(2, static_cast<Eigen::Index>(columns.size()));
    for (size_t k = 0; k < columns.size(); ++k) part.col(static_cast<Eigen::Index>(k)) = term.by_lens.col(columns[k]);
    return part;
  }

  // `direct`: adds what photos and lenses get without the point, too.
  PointTerms Collect(uint32_t track, bool direct) {
    PointTerms terms;
    for (uint32_t e = bundle.tracks.first[track]; e < bundle.tracks.first[track + 1]; ++e) {
      const uint32_t photo = bundle.tracks.entries[e].photo;
      if (!Counts(bundle, e) || group_of_photo[photo] < 0) continue;
      const int lens = bundle.photos[photo].lens;
      const EntryTerm term = TermOf(bundle, e, bundle.point[track]);
      const double weight = WeightOf(term);
      const SmallMatrix by_pose = term.by_pose.leftCols<6>();
      const int pose_group = group_of_photo[photo], lens_group = group_of_lens[static_cast<size_t>(lens)];
      ++terms.entries;
      terms.information += weight * term.by_point.transpose() * term.by_point;
      terms.Add(pose_group, Weighted(weight, by_pose, term.by_point));
      if (direct) AddBlock(pose_group, pose_group, Weighted(weight, by_pose, by_pose));
      if (lens_group < 0) continue;
      const SmallMatrix by_lens = FreePart(term, lens);
      terms.Add(lens_group, Weighted(weight, by_lens, term.by_point));
      if (!direct) continue;
      AddBlock(lens_group, lens_group, Weighted(weight, by_lens, by_lens));
      AddBlock(lens_group, pose_group, Weighted(weight, by_lens, by_pose));
    }
    return terms;
  }

  void AddKnown(uint32_t track, const KnownPoint& known, PointTerms* terms) const {
    const double weight = KnownWeight(known, bundle.point[track], stage.known_loss);
    terms->information += weight * known.sigma.cwiseAbs2().cwiseInverse().asDiagonal().toDenseMatrix();
  }

  void NumberUnknowns(bool has_shift) {
    std::vector<char> sees(bundle.photos.size(), 0), used(bundle.lenses.size(), 0);
    for (const uint32_t t : tracks) {
      if (bundle.has_point[t] == 0) continue;
      for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) {
        if (!Counts(bundle, e)) continue;
        sees[bundle.tracks.entries[e].photo] = 1;
        used[static_cast<size_t>(bundle.photos[bundle.tracks.entries[e].photo].lens)] = 1;
      }
    }
    first = {0};
    const auto add = [&](int unknowns) {
      first.push_back(first.back() + unknowns);
      return static_cast<int>(first.size()) - 2;
    };
    for (size_t i = 0; i < sees.size(); ++i) group_of_photo.push_back(sees[i] != 0 ? add(6) : -1);
    for (size_t i = 0; i < used.size(); ++i) {
      const std::vector<int> held = HeldNumbersOf(bundle.lenses[i]);
      std::vector<int> free;
      for (int k = 0; k < CountNumbers(bundle.lenses[i].camera); ++k) {
        if (std::find(held.begin(), held.end(), k) == held.end()) free.push_back(k);
      }
      group_of_lens.push_back(used[i] != 0 && stage.free_lens ? add(static_cast<int>(free.size())) : -1);
      free_of_lens.push_back(std::move(free));
    }
    const bool tagged = std::any_of(bundle.photos.begin(), bundle.photos.end(), [](const BundlePhoto& photo) { return photo.gps.has_value(); });
    if (has_shift && tagged) shift_group = add(3);
  }

  void AddTags(const Vector3d& shift) {
    for (size_t i = 0; i < bundle.photos.size(); ++i) {
      const BundlePhoto& photo = bundle.photos[i];
      if (!photo.gps || group_of_photo[i] < 0) continue;
      const Vector3d inverse = (stage.gps_factor * photo.gps_sigma).cwiseInverse();
      const double weight = CauchyWeight((photo.centre - *photo.gps - shift).cwiseProduct(inverse).norm(), kTagLoss);
      const Matrix3d information = weight * inverse.cwiseAbs2().asDiagonal().toDenseMatrix();
      SmallMatrix pose = SmallMatrix::Zero(6, 6);
      pose.bottomRightCorner<3, 3>() = information;
      AddBlock(group_of_photo[i], group_of_photo[i], pose);
      if (shift_group < 0) continue;
      SmallMatrix both = SmallMatrix::Zero(3, 6);
      both.rightCols<3>() = -information;
      AddBlock(shift_group, group_of_photo[i], both);
      AddBlock(shift_group, shift_group, information);
    }
  }

  void AddLenses() {
    for (size_t i = 0; i < bundle.lenses.size(); ++i) {
      if (group_of_lens[i] < 0 || !stage.lens_prior) continue;
      const Lens sigma = LensSigma(bundle.lenses[i]);
      SmallMatrix information =
          SmallMatrix::Zero(static_cast<Eigen::Index>(free_of_lens[i].size()), static_cast<Eigen::Index>(free_of_lens[i].size()));
      for (Eigen::Index k = 0; k < information.rows(); ++k) {
        const double one = sigma[static_cast<size_t>(free_of_lens[i][static_cast<size_t>(k)])];
        information(k, k) = 1.0 / (one * one);
      }
      AddBlock(group_of_lens[i], group_of_lens[i], information);
    }
  }

  void Factor() {
    const int n = first.back();
    scale = Eigen::VectorXd::Zero(n);
    std::vector<linear::SparseElement> elements;
    for (size_t group = 0; group + 1 < first.size(); ++group) {
      const auto diagonal = blocks.find(group * first.size() + group);
      if (diagonal == blocks.end()) return;
      for (Eigen::Index k = 0; k < diagonal->second.rows(); ++k) {
        const double value = diagonal->second(k, k);
        if (!(value > 0.0)) return;
        scale[first[group] + k] = 1.0 / std::sqrt(value);
      }
    }
    for (const auto& [key, value] : blocks) {
      const int row = first[key / first.size()], col = first[key % first.size()];
      for (Eigen::Index j = 0; j < value.cols(); ++j) {
        for (Eigen::Index i = 0; i < value.rows(); ++i) {
          if (row + i < col + j) continue;
          elements.push_back({row + static_cast<int>(i), col + static_cast<int>(j), value(i, j) * scale[row + i] * scale[col + j]});
        }
      }
    }
    blocks.clear();
    factors.emplace(n, elements);
    ok = factors->positive_definite();
  }

  // x^T (inverse of the normal equations) x.
  MatrixXd Propagate(const MatrixXd& x) const {
    const MatrixXd scaled = scale.asDiagonal() * x;
    return linear::TransposedProduct(scaled, factors->Solve(scaled));
  }
};

AdjustmentAccuracy::AdjustmentAccuracy(const BundleProblem& bundle, std::span<const uint32_t> tracks, const BundleStage& stage, const Vector3d* shift)
    : impl_(std::make_unique<Impl>(bundle)) {
  Impl& impl = *impl_;
  impl.tracks.assign(tracks.begin(), tracks.end());
  impl.stage = stage;
  impl.NumberUnknowns(shift != nullptr);
  std::unordered_map<uint32_t, const KnownPoint*> known;
  for (const KnownPoint& point : stage.known) known.emplace(point.track, &point);
  for (const uint32_t t : tracks) {
    if (bundle.has_point[t] == 0) continue;
    PointTerms terms = impl.Collect(t, true);
    if (const auto found = known.find(t); found != known.end()) impl.AddKnown(t, *found->second, &terms);
    const Matrix3d inverse = linear::Inverse(terms.information);
    if (!inverse.allFinite()) continue;
    for (size_t a = 0; a < terms.products.size(); ++a) {
      const SmallMatrix left = Times(-terms.products[a].second, inverse);
      for (size_t b = 0; b <= a; ++b)
        impl.AddBlock(terms.products[a].first, terms.products[b].first, Times(left, terms.products[b].second.transpose()));
    }
  }
  impl.AddTags(shift != nullptr ? *shift : Vector3d::Zero());
  impl.AddLenses();
  impl.Factor();
  // The caller's list of known points need not outlive this.
  impl.stage.known = {};
}

AdjustmentAccuracy::~AdjustmentAccuracy() = default;

bool AdjustmentAccuracy::ok() const {
  return impl_->ok;
}

std::optional<Matrix3d> AdjustmentAccuracy::OfPoint(uint32_t track, const KnownPoint* known) const {
  if (!impl_->ok || impl_->bundle.has_point[track] == 0) return std::nullopt;
  PointTerms terms = impl_->Collect(track, false);
  if (terms.entries < 2) return std::nullopt;
  if (known != nullptr) impl_->AddKnown(track, *known, &terms);
  const Matrix3d inverse = linear::Inverse(terms.information);
  if (!inverse.allFinite()) return std::nullopt;
  MatrixXd motion = MatrixXd::Zero(impl_->first.back(), 3);
  for (const auto& [group, product] : terms.products)
    motion.middleRows(impl_->first[static_cast<size_t>(group)], product.rows()) += Times(product, inverse);
  return inverse + impl_->Propagate(motion);
}

std::optional<double> AdjustmentAccuracy::OfLens(size_t lens, int number) const {
  if (!impl_->ok || impl_->group_of_lens[lens] < 0) return std::nullopt;
  const std::vector<int>& free = impl_->free_of_lens[lens];
  const auto found = std::find(free.begin(), free.end(), number);
  if (found == free.end()) return std::nullopt;
  const auto group = static_cast<size_t>(impl_->group_of_lens[lens]);
  return impl_->Propagate(Eigen::VectorXd::Unit(impl_->first.back(), impl_->first[group] + (found - free.begin())))(0, 0);
}

geo::PlaceAccuracy AdjustmentAccuracy::OfPlace() const {
  if (!impl_->ok) return {};
  const BundleProblem& bundle = impl_->bundle;
  constexpr size_t kMaxPoints = 300;
  std::vector<uint32_t> chosen;
  const size_t step = std::max<size_t>(1, impl_->tracks.size() / kMaxPoints);
  for (size_t i = 0; i < impl_->tracks.size(); i += step) {
    if (bundle.has_point[impl_->tracks[i]] != 0) chosen.push_back(impl_->tracks[i]);
  }
  Vector3d middle = Vector3d::Zero();
  for (const uint32_t t : chosen) middle += bundle.point[t] / static_cast<double>(chosen.size());
  Eigen::Matrix<double, 7, 7> normal = Eigen::Matrix<double, 7, 7>::Zero();
  MatrixXd motion = MatrixXd::Zero(impl_->first.back(), 7);
  for (const uint32_t t : chosen) {
    const PointTerms terms = impl_->Collect(t, false);
    const Matrix3d inverse = linear::Inverse(terms.information);
    if (!inverse.allFinite()) continue;
    const Eigen::Matrix<double, 3, 7> jacobian = SimilarityJacobian(bundle.point[t] - middle);
    normal += jacobian.transpose() * jacobian;
    for (const auto& [group, product] : terms.products) {
      motion.middleRows(impl_->first[static_cast<size_t>(group)], product.rows()) += Times(Times(product, inverse), jacobian);
    }
  }
  const Eigen::Matrix<double, 7, 7> solve = linear::Inverse(normal);
  if (!solve.allFinite()) return {};
  const Eigen::Matrix<double, 7, 7> covariance = impl_->Propagate(linear::Product(motion, solve));
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  return {.scale_percent = 100.0 * std::sqrt(covariance(6, 6)),
          .tilt_deg = kDegrees * std::sqrt(covariance(3, 3) + covariance(4, 4)),
          .yaw_deg = kDegrees * std::sqrt(covariance(5, 5)),
          .horizontal_m = std::sqrt(covariance(0, 0) + covariance(1, 1)),
          .vertical_m = std::sqrt(covariance(2, 2))};
}

double KnownWeight(const KnownPoint& known, const Vector3d& x_in_enu, double loss) {
  return HuberWeight((x_in_enu - known.place).cwiseQuotient(known.sigma).norm(), loss);
}

Eigen::Matrix<double, 3, 7> SimilarityJacobian(const Vector3d& from_middle) {
  Eigen::Matrix<double, 3, 7> jacobian;
  const Vector3d& d = from_middle;
  jacobian.leftCols<3>().setIdentity();
  jacobian.middleCols<3>(3) << 0.0, d.z(), -d.y(), -d.z(), 0.0, d.x(), d.y(), -d.x(), 0.0;
  jacobian.col(6) = d;
  return jacobian;
}

}  // namespace skyquilt::prepare::bundle
