#include "surface/refine/refine_views.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "core/base/amounts.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "surface/refine/neighbours.h"
#include "surface/refine/photo_picture.h"
#include "surface/refine/refine_view.h"
#include "surface/views/render_depth_views.h"
#include "surface/views/view_files.h"

namespace skyquilt::surface {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMatchedFolder = "matched";     // in that of the rendered views: what each photo finds by itself
constexpr size_t kSources = 8;                        // photos that each is compared with
constexpr float kLeastCorrelation = 0.4F;             // of a depth that is taken
constexpr int kLeastAgreeing = 1;                     // other photos that must find the same place
constexpr double kAgreement_px = 1.0;                 // disparity by which they may differ
constexpr uint8_t kRenderedWeight = kFullWeight / 2;  // of depths that remain as rendered
constexpr double kShareOfMemory = 0.1;

// The results of `make` for the indices that were asked for last.
template <typename T>
class Recent {
 public:
  explicit Recent(size_t most) : most_(most) {}
  template <typename Make>
  std::shared_ptr<const T> Get(size_t index, const Make& make) {
    auto found = kept_.find(index);
    if (found == kept_.end()) {
      if (kept_.size() >= most_) {
        kept_.erase(std::min_element(kept_.begin(), kept_.end(), [](const auto& a, const auto& b) { return a.second.used < b.second.used; }));
      }
      found = kept_.emplace(index, Entry{std::make_shared<const T>(make(index)), 0}).first;
    }
    found->second.used = ++clock_;
    return found->second.value;
  }

 private:
  struct Entry {
    std::shared_ptr<const T> value;
    int64_t used = 0;
  };
  size_t most_;
  int64_t clock_ = 0;
  std::map<size_t, Entry> kept_;
};

// Depths of a matched view as inverse depths along its axis, where photos were matched.
struct MatchedDepths {
  ViewPose pose;
  std::vector<float> inverse_depth;  // NaN: as rendered

  explicit MatchedDepths(const RenderedView& view) : pose(view.pose), inverse_depth(view.depth_m.size(), std::numeric_limits<float>::quiet_NaN()) {
    for (int y = 0; y < pose.height; ++y) {
      for (int x = 0; x < pose.width; ++x) {
        const size_t i = static_cast<size_t>(y) * static_cast<size_t>(pose.width) + static_cast<size_t>(x);
        if (view.weight[i] == kConfirmedWeight) inverse_depth[i] = static_cast<float>(LengthAt(pose, x, y) / static_cast<double>(view.depth_m[i]));
      }
    }
  }

  // Between the four pixels around the position, or that of the nearest where they are not all known.
  double At(const Eigen::Vector2d& pixel) const {
    const int x = std::clamp(static_cast<int>(std::floor(pixel.x() - 0.5)), 0, pose.width - 2);
    const int y = std::clamp(static_cast<int>(std::floor(pixel.y() - 0.5)), 0, pose.height - 2);
    const double fx = std::clamp(pixel.x() - 0.5 - x, 0.0, 1.0), fy = std::clamp(pixel.y() - 0.5 - y, 0.0, 1.0);
    const auto at = [&](int dx, int dy) {
      return static_cast<double>(inverse_depth[static_cast<size_t>(y + dy) * static_cast<size_t>(pose.width) + static_cast<size_t>(x + dx)]);
    };
    const double between = (at(0, 0) * (1.0 - fx) + at(1, 0) * fx) * (1.0 - fy) + (at(0, 1) * (1.0 - fx) + at(1, 1) * fx) * fy;
    return std::isnan(between) ? at(fx < 0.5 ? 0 : 1, fy < 0.5 ? 0 : 1) : between;
  }
};

class Refiner {
 public:
  Refiner(const SurfaceInput& input, std::span<const ViewPose> poses, std::string key, fs::path folder, std::vector<fs::path>* files,
          base::ThreadPool& threads)
      : input_(input),
        poses_(poses),
        key_(std::move(key)),
        matched_folder_(folder / kMatchedFolder),
        improved_folder_(folder / kImprovedFolder),
        files_(*files),
        threads_(threads),
        pictures_(MostInMemory(sizeof(uint32_t))),
        matched_(MostInMemory(sizeof(float))) {}

  void Run() {
    const auto start = std::chrono::steady_clock::now();
    base::RequireWritableFolder(matched_folder_);
    base::RequireWritableFolder(improved_folder_);
    base::Progress matching("surface depths by photos", static_cast<double>(poses_.size()), "photos");
    for (size_t i = 0; i < poses_.size(); ++i) {
      base::ThrowIfCancelled();
      if (!Improved(i) && !LoadView(matched_folder_ / ViewFileName(i), poses_[i], key_)) Match(i);
      matching.Advance(1.0);
    }
    matching.Finish();
    base::Progress agreeing("surface depths that agree", static_cast<double>(poses_.size()), "photos");
    for (size_t i = 0; i < poses_.size(); ++i) {
      base::ThrowIfCancelled();
      if (!Improved(i)) Agree(i);
      std::error_code ignored;
      fs::remove(files_[i], ignored);
      files_[i] = improved_folder_ / ViewFileName(i);
      agreeing.Advance(1.0);
    }
    agreeing.Finish();
    std::error_code ignored;
    fs::remove_all(matched_folder_, ignored);
    if (total_ == 0) return;
    base::LogInfo("surface depths: {:.0f} % of the photos' depths are improved by other photos, by {:.2g} pixels in the median, in {}",
                  100.0 * static_cast<double>(agreed_) / static_cast<double>(total_), moves_.empty() ? 0.0 : base::UpperMedian(moves_),
                  base::FormatDuration(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()));
  }

 private:
  size_t MostInMemory(size_t pixel_bytes) const {
    size_t largest = 1;
    for (const ViewPose& pose : poses_) largest = std::max(largest, static_cast<size_t>(pose.width) * static_cast<size_t>(pose.height));
    const double most = 0.5 * kShareOfMemory * input_.memory_bytes / static_cast<double>(largest * pixel_bytes);
    return std::max(kSources + 1, static_cast<size_t>(std::min(most, static_cast<double>(poses_.size()))));
  }

  bool Improved(size_t i) const { return LoadView(improved_folder_ / ViewFileName(i), poses_[i], key_).has_value(); }

  RenderedView Load(const fs::path& file, size_t i) const { return RequireView(file, poses_[i], key_); }

  // What the photo finds by itself; of a damaged file what remains of that in the improved view.
  RenderedView LoadMatched(size_t i) const {
    if (std::optional<RenderedView> view = LoadView(matched_folder_ / ViewFileName(i), poses_[i], key_)) return std::move(*view);
    return Load(improved_folder_ / ViewFileName(i), i);
  }

  std::shared_ptr<const kernel::MatchPicture> Picture(size_t i) {
    return pictures_.Get(i, [&](size_t index) { return PictureOf(poses_[index], *input_.survey, *input_.photos, threads_); });
  }

  // Saves the view with matched depths in the place of rendered ones where photos agree well enough; their weight is kConfirmedWeight.
  void Match(size_t i) {
    RenderedView view = Load(files_[i], i);
    view.weight.assign(view.depth_m.size(), kRenderedWeight);
    const std::vector<size_t> neighbours = NeighboursOf(i, view.Get(), poses_, kSources);
    std::vector<std::shared_ptr<const kernel::MatchPicture>> pictures;
    std::vector<RefineSource> sources;
    for (const size_t other : neighbours) {
      pictures.push_back(Picture(other));
      sources.push_back({pictures.back().get(), poses_[other]});
    }
    if (sources.size() >= 2) {
      const RefinedDepth refined = RefineDepth(poses_[i], view.depth_m, *Picture(i), sources, {}, threads_);
      threads_.ParallelFor(poses_[i].height, [&](int64_t row, int) { TakeRow(refined, static_cast<int>(row), &view); });
    }
    SaveView(view, key_, matched_folder_ / ViewFileName(i));
  }

  static void TakeRow(const RefinedDepth& refined, int y, RenderedView* view) {
    const ViewPose& pose = view->pose;
    for (int x = 0; x < pose.width; ++x) {
      const size_t at = static_cast<size_t>(y) * static_cast<size_t>(pose.width) + static_cast<size_t>(x);
      if (!(refined.correlation[at] >= kLeastCorrelation)) continue;
      const double length = LengthAt(pose, x, y), a = static_cast<double>(refined.inverse_depth[at]);
      view->depth_m[at] = static_cast<float>(length / a);
      view->cosine[at] = static_cast<uint8_t>(std::clamp(std::lround(255.0 * refined.CosineAt(pose, x, y)), 1L, kMeetsNothing - 1L));
      view->weight[at] = kConfirmedWeight;
    }
  }

  // Saves the rendered view with the matched depths that other photos found too.
  void Agree(size_t i) {
    RenderedView view = Load(files_[i], i);
    const RenderedView matched = Load(matched_folder_ / ViewFileName(i), i);
    view.weight.assign(view.depth_m.size(), kRenderedWeight);
    std::vector<std::shared_ptr<const MatchedDepths>> others;
    std::vector<double> scale;  // pixels of disparity per inverse depth
    for (const size_t other : NeighboursOf(i, view.Get(), poses_, kSources)) {
      others.push_back(matched_.Get(other, [&](size_t index) { return MatchedDepths(LoadMatched(index)); }));
      scale.push_back((poses_[other].Centre() - poses_[i].Centre()).norm() * poses_[other].focal_px);
    }
    std::atomic<int64_t> total{0}, agreed{0};
    std::vector<double> moves(static_cast<size_t>(view.pose.height), std::numeric_limits<double>::quiet_NaN());
    threads_.ParallelFor(view.pose.height, [&](int64_t row, int) {
      const ViewPose& pose = view.pose;
      for (int x = 0; x < pose.width; ++x) {
        const size_t at = static_cast<size_t>(row) * static_cast<size_t>(pose.width) + static_cast<size_t>(x);
        const bool had = view.depth_m[at] > 0.0F;
        total += had ? 1 : 0;
        if (matched.weight[at] != kConfirmedWeight) continue;
        const Eigen::Vector3d place =
            pose.Centre() + static_cast<double>(matched.depth_m[at]) * pose.DirectionAt(x + 0.5, static_cast<double>(row) + 0.5);
        int agreeing = 0;
        for (size_t k = 0; k < others.size() && agreeing < kLeastAgreeing; ++k) {
          const std::optional<Eigen::Vector2d> pixel = others[k]->pose.Project(place);
          if (!pixel) continue;
          const double a = 1.0 / (others[k]->pose.cam_from_enu * place).z();
          if (std::abs(a - others[k]->At(*pixel)) * scale[k] < kAgreement_px) ++agreeing;
        }
        if (agreeing < kLeastAgreeing) continue;
        ++agreed;
        if (had && x == pose.width / 2) {
          const double length = LengthAt(pose, x, static_cast<int>(row));
          moves[static_cast<size_t>(row)] =
              std::abs(length / static_cast<double>(view.depth_m[at]) - length / static_cast<double>(matched.depth_m[at])) * scale[scale.size() / 2];
        }
        view.depth_m[at] = matched.depth_m[at];
        view.cosine[at] = matched.cosine[at];
        view.weight[at] = kConfirmedWeight;
      }
    });
    total_ += total;
    agreed_ += agreed;
    for (const double move : moves) {
      if (!std::isnan(move)) moves_.push_back(move);
    }
    SaveView(view, key_, improved_folder_ / ViewFileName(i));
  }

  const SurfaceInput& input_;
  std::span<const ViewPose> poses_;
  std::string key_;
  fs::path matched_folder_, improved_folder_;
  std::vector<fs::path>& files_;
  base::ThreadPool& threads_;
  Recent<kernel::MatchPicture> pictures_;
  Recent<MatchedDepths> matched_;
  int64_t total_ = 0, agreed_ = 0;
  std::vector<double> moves_;  // disparities by which depths of the middle columns changed, pixels
};

}  // namespace

void RefineViews(const SurfaceInput& input, std::span<const ViewPose> poses, const std::string& key, const fs::path& folder,
                 std::vector<fs::path>* files, base::ThreadPool& threads) {
  Refiner(input, poses, key, folder, files, threads).Run();
}

}  // namespace skyquilt::surface
