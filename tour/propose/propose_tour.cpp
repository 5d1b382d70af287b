#include "tour/propose/propose_tour.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "core/base/checked_json.h"
#include "tour/propose/choose_view.h"
#include "tour/propose/relief.h"

namespace skyquilt::tour {
namespace {

constexpr double kPause_s = 4.0;
constexpr double kLeastSeen = 0.1;

// A stop that is not the overview, before its place in the round is known.
struct Sight {
  std::string id, title, text;
  Subject subject;
};

// "flat roof"; empty: nothing that is worth saying.
std::string RoofText(const std::string& roof) {
  if (roof == "flat") return "It has a flat roof. ";
  if (roof == "gable") return "It has a gable roof. ";
  if (roof == "hip") return "It has a hip roof. ";
  return "";
}

Sight SightOf(const BuildingMark& building) {
  Sight sight;
  sight.id = fmt::format("building-{}", building.id);
  sight.title = fmt::format("Building {}", building.id);
  sight.text = RoofText(building.roof);
  if (building.metric) {
    const double height = building.scale * building.height_m, length = building.scale * building.length_m, width = building.scale * building.width_m;
    sight.title += fmt::format(", {:.1f} m high", height);
    sight.text = fmt::format("{:.1f} m long, {:.1f} m wide and {:.1f} m high. {}", length, width, height, sight.text);
  }
  while (sight.text.ends_with(' ')) sight.text.pop_back();
  sight.subject = {.foot_enu = building.middle_enu, .radius_m = 0.5 * std::hypot(building.length_m, building.width_m), .height_m = building.height_m};
  return sight;
}

Sight SightOf(const ReliefPlace& place, int number, bool metric) {
  Sight sight;
  sight.id = fmt::format("place-{}", number);
  sight.title = fmt::format("Place {}", number);
  if (metric) {
    sight.title += fmt::format(", {:.1f} m of relief", place.relief_m);
    sight.text = fmt::format("Here the surface rises by {:.1f} m within {:.0f} m.", place.relief_m, place.size_m);
  }
  sight.subject = {.foot_enu = place.low_enu, .radius_m = 0.5 * place.size_m, .height_m = place.relief_m};
  return sight;
}

// Well modelled ones first, of these the largest whose walls were seen.
std::vector<BuildingMark> BestBuildings(std::vector<BuildingMark> buildings, int most) {
  std::erase_if(buildings, [](const BuildingMark& b) {
    return !(b.middle_enu.allFinite() && b.length_m > 0.0 && b.width_m > 0.0 && b.height_m > 0.0 &&
             std::isfinite(b.length_m * b.width_m * b.height_m));
  });
  std::sort(buildings.begin(), buildings.end(), [](const BuildingMark& a, const BuildingMark& b) {
    const auto rank = [](const BuildingMark& one) {
      return std::tuple(!one.accepted, -one.length_m * one.width_m * one.height_m * std::max(kLeastSeen, one.seen), one.id);
    };
    return rank(a) < rank(b);
  });
  if (buildings.size() > static_cast<size_t>(most)) buildings.resize(static_cast<size_t>(most));
  return buildings;
}

bool IsTitle(const std::string& text) {
  return std::none_of(text.begin(), text.end(), base::IsControl) && base::CharactersIn(text) <= kMaxTitleCharacters;
}

Stop StopWith(const std::string& id, const std::string& title, const std::string& text, const Pose& pose) {
  Stop stop;
  stop.id = id;
  stop.title = title;
  stop.text = text;
  stop.pose = pose;
  stop.pause_s = kPause_s;
  stop.next = Next{};
  return stop;
}

}  // namespace

Tour ProposeTour(const ProposeInput& input) {
  const Eigen::Vector2d middle = input.box_enu.center().head<2>();
  std::vector<Sight> sights;
  std::vector<Eigen::Vector2d> taken;
  for (const BuildingMark& building : BestBuildings(input.buildings, input.stops - 1)) {
    sights.push_back(SightOf(building));
    taken.emplace_back(building.middle_enu.head<2>());
  }
  if (const int left = input.stops - 1 - static_cast<int>(sights.size()); left > 0 && input.heights != nullptr) {
    int number = 0;
    for (const ReliefPlace& place : FindRelief(*input.heights, left, taken)) sights.push_back(SightOf(place, ++number, input.metric));
  }
  // A round, clockwise from the south, where the overview is.
  const auto bearing = [&](const Sight& sight) {
    const Eigen::Vector2d d = sight.subject.foot_enu.head<2>() - middle;
    const double angle = std::atan2(-d.x(), -d.y());  // 0 in the south, grows to the west
    return angle < 0.0 ? angle + 2.0 * std::numbers::pi : angle;
  };
  std::stable_sort(sights.begin(), sights.end(), [&](const Sight& a, const Sight& b) { return bearing(a) < bearing(b); });

  Tour tour;
  if (IsTitle(input.name)) tour.title = input.name;
  std::string text;
  if (input.metric) {
    const Eigen::Vector3d size = input.box_enu.sizes();
    text = fmt::format("The surveyed area is {:.0f} m by {:.0f} m.", size.x(), size.y());
  }
  tour.stops.push_back(StopWith("overview", "Overview", text, Overview(input.box_enu, input.ground_m)));
  for (const Sight& sight : sights) tour.stops.push_back(StopWith(sight.id, sight.title, sight.text, ViewOf(sight.subject, middle, input.heights)));
  if (tour.stops.size() > 1) {
    tour.stops.back().next->to = tour.stops.front().id;
  } else {
    tour.stops.back().next.reset();
  }
  return tour;
}

}  // namespace skyquilt::tour
