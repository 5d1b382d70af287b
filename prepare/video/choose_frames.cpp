#include "prepare/video/choose_frames.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace skyquilt::prepare::video {
namespace {

constexpr double kWidestWindow = 0.05, kWindowShare = 0.2;
// A frame that is blurred has less than this share of the sharpness of one shortly before.
constexpr double kBlurred = 0.5;
// Of the new share: frames nearer than this to the chosen one before are not worth having.
constexpr double kNearest = 0.5;

class FrameChooser {
 public:
  FrameChooser(std::span<const Candidate> candidates, double aspect, double new_share)
      : candidates_(candidates), aspect_(aspect), wanted_(new_share), window_(std::min(kWidestWindow, kWindowShare * new_share)) {}

  std::vector<ChosenFrame> Choose() {
    size_t begin = 0;
    while (begin < candidates_.size()) {
      AddFirst(begin, begin == 0 ? FrameReason::kFirst : FrameReason::kJump);
      while (const std::optional<ChosenFrame> next = After(chosen_.back().candidate)) chosen_.push_back(*next);
      while (begin < candidates_.size() && candidates_[begin].section == candidates_[chosen_.back().candidate].section) ++begin;
    }
    return std::move(chosen_);
  }

 private:
  bool Sharper(size_t i, size_t than) const { return candidates_[i].sharpness > candidates_[than].sharpness; }
  double ShareOf(size_t from, size_t to) const { return NewShare(candidates_[from].from_first.Inverse().Then(candidates_[to].from_first), aspect_); }
  bool SameSection(size_t i, size_t j) const { return j < candidates_.size() && candidates_[i].section == candidates_[j].section; }

  void AddFirst(size_t begin, FrameReason reason) {
    ChosenFrame frame{.candidate = begin, .reason = reason};
    for (size_t i = begin + 1; SameSection(begin, i) && ShareOf(begin, i) <= window_; ++i) {
      ++frame.n_compared;
      if (Sharper(i, frame.candidate)) frame.candidate = i;
    }
    chosen_.push_back(frame);
  }

  std::optional<ChosenFrame> After(size_t last) const {
    std::optional<size_t> in_window, before, latest, beyond;
    size_t n_compared = 0;
    for (size_t i = last + 1; SameSection(last, i); ++i) {
      const double share = ShareOf(last, i);
      if (share > wanted_ + window_) {
        beyond = i;
        break;
      }
      if (share >= wanted_ - window_) {
        ++n_compared;
        if (!in_window || Sharper(i, *in_window)) in_window = i;
      } else if (share >= kNearest * wanted_) {
        latest = i;
        if (!before || Sharper(i, *before)) before = i;
      }
    }
    const auto frame = [&](size_t i, FrameReason reason, size_t n) { return ChosenFrame{i, reason, 1.0 - ShareOf(last, i), n}; };
    if (in_window) {
      const bool blurred = before && *before < *in_window && candidates_[*in_window].sharpness < kBlurred * candidates_[*before].sharpness;
      return blurred ? frame(*before, FrameReason::kSharper, n_compared + 1) : frame(*in_window, FrameReason::kOverlap, n_compared);
    }
    // What comes next is too far away: the last one before it.
    if (beyond) return latest ? frame(*latest, FrameReason::kOverlap, 1) : frame(*beyond, FrameReason::kFast, 1);
    if (latest) return frame(*latest, FrameReason::kLast, 1);
    return std::nullopt;
  }

  std::span<const Candidate> candidates_;
  double aspect_, wanted_, window_;
  std::vector<ChosenFrame> chosen_;
};

FrameChoice ChoiceFor(const std::vector<VideoCandidates>& videos, double overlap) {
  FrameChoice choice{.frames = {}, .overlap = overlap};
  for (const VideoCandidates& video : videos) choice.frames.push_back(ChooseFrames(video.candidates, video.aspect, overlap));
  return choice;
}

size_t CountOf(const FrameChoice& choice) {
  size_t n = 0;
  for (const std::vector<ChosenFrame>& frames : choice.frames) n += frames.size();
  return n;
}

void Thin(size_t limit, FrameChoice& choice) {
  const size_t n_all = CountOf(choice);
  size_t at = 0, n_kept = 0;
  for (std::vector<ChosenFrame>& frames : choice.frames) {
    std::vector<ChosenFrame> kept;
    for (const ChosenFrame& frame : frames) {
      // Kept are `limit` of all, evenly.
      if (at * limit / n_all >= n_kept) {
        kept.push_back(frame);
        ++n_kept;
      }
      ++at;
    }
    frames = std::move(kept);
  }
  choice.thinned = true;
}

}  // namespace

std::vector<ChosenFrame> ChooseFrames(std::span<const Candidate> candidates, double aspect, double overlap) {
  return FrameChooser(candidates, aspect, 1.0 - overlap).Choose();
}

FrameChoice ChooseFramesOfAll(const std::vector<VideoCandidates>& videos, double overlap, int limit) {
  FrameChoice choice = ChoiceFor(videos, overlap);
  const auto most = static_cast<size_t>(std::max(0, limit));
  if (limit <= 0 || CountOf(choice) <= most) return choice;
  double more = overlap, less = 0.0;
  choice = ChoiceFor(videos, less);
  if (CountOf(choice) > most) {
    Thin(most, choice);
    return choice;
  }
  constexpr int kHalvings = 12;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (more + less);
    FrameChoice tried = ChoiceFor(videos, middle);
    if (CountOf(tried) <= most) {
      less = middle;
      choice = std::move(tried);
    } else {
      more = middle;
    }
  }
  return choice;
}

}  // namespace skyquilt::prepare::video
