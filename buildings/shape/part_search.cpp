#include "buildings/shape/part_search.h"

#include <algorithm>
#include <limits>

#include "buildings/shape/cell_rectangles.h"
#include "core/base/cancel.h"

namespace skyquilt::buildings {
namespace {

using Rectangles = std::vector<CellRectangle>;

constexpr double kLeastGain_m2 = 0.05;
constexpr int kMostSteps = 40;
constexpr size_t kMostParts = 12;

class Search {
 public:
  Search(const WallCells& cells, const Rectangles& candidates, PartScorer* scorer) : cells_(cells), candidates_(candidates), scorer_(scorer) {}

  ScoredShape Find() {
    Offer({Around(Inside())});
    OfferCovers();
    for (const CellRectangle& one : candidates_) Offer({one});
    for (int step = 0; step < kMostSteps; ++step) {
      base::ThrowIfCancelled();
      const double before = best_.cost;
      const Rectangles from = best_.rectangles;
      Drop(from);
      Split(from);
      Join(from);
      Move(from);
      Replace(from);
      Add(from);
      if (!(best_.cost < before - kLeastGain_m2)) break;
    }
    return Sorted();
  }

 private:
  void Offer(const Rectangles& rectangles) {
    if (rectangles.empty() || rectangles.size() > kMostParts) return;
    ScoredShape scored = scorer_->Score(rectangles);
    if (scored.cost < best_.cost - (best_.rectangles.empty() ? 0.0 : 1e-9)) best_ = std::move(scored);
  }

  Rectangles Inside() const {
    Rectangles all;
    for (int row = 0; row < cells_.Rows(); ++row) {
      for (int column = 0; column < cells_.Columns(); ++column) {
        if (cells_.inside[cells_.Index(column, row)] != 0) all.push_back({column, column + 1, row, row + 1});
      }
    }
    if (all.empty()) all.push_back({0, cells_.Columns(), 0, cells_.Rows()});
    return all;
  }

  static CellRectangle Around(const Rectangles& rectangles) {
    CellRectangle around = rectangles.front();
    for (const CellRectangle& r : rectangles) {
      around = {std::min(around.u0, r.u0), std::max(around.u1, r.u1), std::min(around.v0, r.v0), std::max(around.v1, r.v1)};
    }
    return around;
  }

  // Greedy covers of the inside: by the candidate that covers most of what is left, and every beginning of that list; then without the candidates
  // that reach over others, so that regions beside each other stay apart.
  void OfferCovers() {
    for (size_t first = 0; first < std::min<size_t>(candidates_.size(), 8); ++first) {
      for (const bool may_overlap : {true, false}) {
        std::vector<uint8_t> left = cells_.inside;
        Rectangles cover;
        const auto take = [&](const CellRectangle& r) {
          cover.push_back(r);
          for (int row = r.v0; row < r.v1; ++row) {
            for (int column = r.u0; column < r.u1; ++column) left[cells_.Index(column, row)] = 0;
          }
          Offer(cover);
        };
        take(candidates_[first]);
        while (cover.size() < kMostParts) {
          const CellRectangle* next = MostOf(left, may_overlap);
          if (next == nullptr) break;
          take(*next);
        }
      }
    }
  }

  const CellRectangle* MostOf(const std::vector<uint8_t>& left, bool may_overlap) const {
    const CellRectangle* best = nullptr;
    double most = 1.0;
    for (const CellRectangle& r : candidates_) {
      double area = 0.0;
      for (int row = r.v0; row < r.v1; ++row) {
        for (int column = r.u0; column < r.u1; ++column) area += left[cells_.Index(column, row)] != 0 ? cells_.AreaOf(column, row) : 0.0;
      }
      if (area <= most || (!may_overlap && area < cells_.AreaOf(r) - 1e-6)) continue;
      most = area;
      best = &r;
    }
    return best;
  }

  void Drop(const Rectangles& from) {
    for (size_t i = 0; i < from.size() && from.size() > 1; ++i) {
      Rectangles to = from;
      to.erase(to.begin() + static_cast<std::ptrdiff_t>(i));
      Offer(std::move(to));
    }
  }

  void Join(const Rectangles& from) {
    for (size_t i = 0; i < from.size(); ++i) {
      for (size_t k = i + 1; k < from.size(); ++k) {
        Rectangles to = from;
        to[i] = Around({from[i], from[k]});
        to.erase(to.begin() + static_cast<std::ptrdiff_t>(k));
        Offer(std::move(to));
        CellRectangle rest;
        if (Without(from[i], from[k], &rest)) Offer(With(from, i, rest));
        if (Without(from[k], from[i], &rest)) Offer(With(from, k, rest));
      }
    }
  }

  // At each line between its sides: houses of a row may differ too little for a step.
  void Split(const Rectangles& from) {
    for (size_t i = 0; i < from.size(); ++i) {
      for (int line = from[i].u0 + 1; line < from[i].u1; ++line) {
        Rectangles to = With(from, i, {from[i].u0, line, from[i].v0, from[i].v1});
        to.push_back({line, from[i].u1, from[i].v0, from[i].v1});
        Offer(std::move(to));
      }
      for (int line = from[i].v0 + 1; line < from[i].v1; ++line) {
        Rectangles to = With(from, i, {from[i].u0, from[i].u1, from[i].v0, line});
        to.push_back({from[i].u0, from[i].u1, line, from[i].v1});
        Offer(std::move(to));
      }
    }
  }

  static Rectangles With(Rectangles from, size_t i, const CellRectangle& r) {
    from[i] = r;
    return from;
  }

  // Sides to the next line, of one part or of all that share the line.
  void Move(const Rectangles& from) {
    for (size_t i = 0; i < from.size(); ++i) {
      for (const int by : {-1, 1}) {
        for (int CellRectangle::*side : {&CellRectangle::u0, &CellRectangle::u1, &CellRectangle::v0, &CellRectangle::v1}) {
          Rectangles one = from, all = from;
          one[i].*side += by;
          const bool is_u = side == &CellRectangle::u0 || side == &CellRectangle::u1;
          const int line = from[i].*side;
          for (CellRectangle& r : all) {
            for (int* end : {is_u ? &r.u0 : &r.v0, is_u ? &r.u1 : &r.v1}) *end += *end == line ? by : 0;
          }
          if (AreValid(one)) Offer(std::move(one));
          if (from.size() > 1 && AreValid(all)) Offer(std::move(all));
        }
      }
    }
  }

  bool AreValid(const Rectangles& rectangles) const {
    return std::all_of(rectangles.begin(), rectangles.end(), [&](const CellRectangle& r) {
      return r.u0 >= 0 && r.u1 <= cells_.Columns() && r.v0 >= 0 && r.v1 <= cells_.Rows() && r.u0 < r.u1 && r.v0 < r.v1;
    });
  }

  void Replace(const Rectangles& from) {
    for (size_t i = 0; i < from.size(); ++i) {
      for (const CellRectangle& r : candidates_) Offer(With(from, i, r));
    }
  }

  void Add(const Rectangles& from) {
    for (const CellRectangle& r : candidates_) {
      Rectangles to = from;
      to.push_back(r);
      Offer(to);
      // What it covers of the others may be cut from them.
      for (size_t i = 0; i < from.size(); ++i) {
        CellRectangle rest;
        if (Without(from[i], r, &rest)) Offer(With(to, i, rest));
      }
    }
  }

  // Shape::parts follow the rectangles, so their order is that of falling area.
  ScoredShape Sorted() {
    Rectangles sorted = best_.rectangles;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](const CellRectangle& a, const CellRectangle& b) { return cells_.AreaOf(a) > cells_.AreaOf(b); });
    return scorer_->Score(sorted);
  }

  const WallCells& cells_;
  const Rectangles& candidates_;
  PartScorer* scorer_;
  ScoredShape best_{{}, {}, std::numeric_limits<double>::infinity()};
};

}  // namespace

ScoredShape FindParts(const WallCells& cells, const std::vector<CellRectangle>& candidates, PartScorer* scorer) {
  return Search(cells, candidates, scorer).Find();
}

}  // namespace skyquilt::buildings
