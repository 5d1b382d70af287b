// What of a tour can be played although something that it refers to is not there.
#include <algorithm>
#include <set>

#include "tour/format/read_parts.h"

namespace skyquilt::tour {
namespace {

std::string Quoted(const std::string& text) {
  return "\"" + text + "\"";
}

class Remains {
 public:
  Remains(Tour* tour, const HasAsset& has_asset, std::vector<std::string>* missing) : tour_(*tour), has_asset_(has_asset), missing_(*missing) {}

  void Trim() {
    std::set<std::string> ids;
    std::erase_if(tour_.stops, [&](const Stop& stop) { return IsSecond("stop", stop.title, stop.id, &ids); });
    for (const Stop& stop : tour_.stops) stops_.insert(stop.id);
    std::erase_if(tour_.things, [&](const Thing& thing) { return IsSecond("thing", thing.text, thing.id, &ids); });
    if (tour_.start && !stops_.contains(*tour_.start)) {
      Say("The first stop should be " + Quoted(*tour_.start) + ", which is not there: the tour begins with the first of its list.");
      tour_.start.reset();
    }
    for (Stop& stop : tour_.stops) TrimStop(&stop);
    std::erase_if(tour_.things, [&](Thing& thing) { return !TrimThing(&thing); });
    std::erase_if(tour_.assets, [&](const auto& asset) { return !has_asset_(asset.first, asset.second.bytes); });
  }

 private:
  void Say(std::string sentence) { missing_.push_back(std::move(sentence)); }

  bool IsSecond(const char* what, const std::string& title, const std::string& id, std::set<std::string>* ids) {
    if (ids->insert(id).second) return false;
    Say(std::string("The ") + what + " " + Quoted(title) + " has the id " + Quoted(id) + " of another and is left out.");
    return true;
  }

  bool IsThere(const std::string& asset) const {
    const auto entry = tour_.assets.find(asset);
    return entry != tour_.assets.end() && has_asset_(asset, entry->second.bytes);
  }

  // The name that people know, as far as there is one.
  std::string NameOf(const std::string& asset) const {
    const auto entry = tour_.assets.find(asset);
    return Quoted(entry == tour_.assets.end() ? asset : entry->second.name);
  }

  void TrimStop(Stop* stop) {
    const std::string name = "Stop " + Quoted(stop->title) + ": ";
    if (stop->picture && !IsThere(*stop->picture)) {
      Say(name + "its picture " + NameOf(*stop->picture) + " is missing.");
      stop->picture.reset();
    }
    if (stop->next && stop->next->to && !stops_.contains(*stop->next->to)) {
      Say(name + "the stop " + Quoted(*stop->next->to) + " that should follow is not there: the next of the list follows.");
      stop->next->to.reset();
    }
    std::erase_if(stop->branches, [&](const Branch& branch) {
      if (stops_.contains(branch.to)) return false;
      Say(name + "the branch " + Quoted(branch.label) + " leads to " + Quoted(branch.to) + ", which is not there, and is left out.");
      return true;
    });
  }

  // False when nothing of it can be shown.
  bool TrimThing(Thing* thing) {
    if (thing->kind == ThingKind::kModel && !IsThere(thing->asset)) {
      Say("The model " + Quoted(thing->text) + " is left out: its file " + NameOf(thing->asset) + " is missing.");
      return false;
    }
    if (thing->to && !stops_.contains(*thing->to)) {
      Say("The marker " + Quoted(thing->text) + " leads to " + Quoted(*thing->to) + ", which is not there: it leads nowhere.");
      thing->to.reset();
    }
    if (!thing->stops || thing->stops->empty()) return true;
    std::erase_if(*thing->stops, [&](const std::string& id) { return !stops_.contains(id); });
    if (!thing->stops->empty()) return true;
    Say(Quoted(thing->text) + " is left out: the stops where it should be shown are not there.");
    return false;
  }

  Tour& tour_;
  const HasAsset& has_asset_;
  std::vector<std::string>& missing_;
  std::set<std::string> stops_;
};

}  // namespace

void LeaveOutDangling(Tour* tour, const HasAsset& has_asset, std::vector<std::string>* missing) {
  Remains(tour, has_asset, missing).Trim();
}

PlayableTour ReadTourToPlay(std::string_view text, const HasAsset& has_asset) {
  Reading reading;
  PlayableTour playable;
  playable.tour = ReadMembers(text, &reading);
  playable.missing = std::move(reading.missing);
  LeaveOutDangling(&playable.tour, has_asset, &playable.missing);
  return playable;
}

}  // namespace skyquilt::tour
