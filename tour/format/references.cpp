// A tour that is saved refers only to what there is.
#include <set>

#include "tour/format/read_parts.h"

namespace skyquilt::tour {
namespace {

class Ids {
 public:
  explicit Ids(const Tour& tour) : tour_(tour) {
    for (size_t i = 0; i < tour.stops.size(); ++i) Add(tour.stops[i].id, "stops[" + std::to_string(i) + "].id");
    stops_ = all_;
    for (size_t i = 0; i < tour.things.size(); ++i) Add(tour.things[i].id, "things[" + std::to_string(i) + "].id");
  }

  void RequireStop(const std::string& id, const std::string& path) const {
    if (!stops_.contains(id)) throw base::Refused(path + " must be the id of a stop: there is no stop \"" + id + "\"");
  }
  void RequireAsset(const std::string& name, const std::string& path) const {
    if (!tour_.assets.contains(name)) throw base::Refused(path + " must be listed in assets: there is no \"" + name + "\"");
  }

 private:
  void Add(const std::string& id, const std::string& path) {
    if (!all_.insert(id).second) throw base::Refused(path + " \"" + id + "\" is the id of another stop or thing, too");
  }

  const Tour& tour_;
  std::set<std::string> all_, stops_;
};

}  // namespace

void CheckReferences(const Tour& tour) {
  const Ids ids(tour);
  if (tour.start) ids.RequireStop(*tour.start, "start");
  for (size_t i = 0; i < tour.stops.size(); ++i) {
    const Stop& stop = tour.stops[i];
    const std::string path = "stops[" + std::to_string(i) + "].";
    if (stop.picture) ids.RequireAsset(*stop.picture, path + "picture");
    if (stop.next && stop.next->to) ids.RequireStop(*stop.next->to, path + "next.to");
    for (size_t k = 0; k < stop.branches.size(); ++k) ids.RequireStop(stop.branches[k].to, path + "branches[" + std::to_string(k) + "].to");
  }
  for (size_t i = 0; i < tour.things.size(); ++i) {
    const Thing& thing = tour.things[i];
    const std::string path = "things[" + std::to_string(i) + "].";
    if (thing.to) ids.RequireStop(*thing.to, path + "to");
    if (thing.kind == ThingKind::kModel) ids.RequireAsset(thing.asset, path + "asset");
    if (!thing.stops) continue;
    for (const std::string& stop : *thing.stops) ids.RequireStop(stop, path + "stops");
  }
}

}  // namespace skyquilt::tour
