#include "products/product_kinds.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/text.h"
#include "core/config/options.h"

namespace skyquilt::products {
namespace {

constexpr std::array<std::pair<const char*, bool ProductKinds::*>, 6> kKinds = {{{"ortho", &ProductKinds::ortho},
                                                                                 {"dsm", &ProductKinds::dsm},
                                                                                 {"terrain", &ProductKinds::terrain},
                                                                                 {"buildings", &ProductKinds::buildings},
                                                                                 {"video", &ProductKinds::video},
                                                                                 {"elevations", &ProductKinds::elevations}}};

}  // namespace

ProductKinds KindsOf(const std::string& kinds, bool looks_level) {
  ProductKinds made;
  if (kinds == "all" || kinds == "auto") {
    for (const auto& [name, member] : kKinds) made.*member = true;
    if (kinds == "all") return made;
    if (looks_level) return {.video = true, .elevations = true, .along_cameras = true};
    made.elevations = false;
    return made;
  }
  std::vector<std::string> known = {"auto", "all"};
  for (const auto& [name, member] : kKinds) known.emplace_back(name);
  for (size_t begin = 0; begin <= kinds.size();) {
    const size_t end = std::min(kinds.find(',', begin), kinds.size());
    std::string word = kinds.substr(begin, end - begin);
    std::erase(word, ' ');
    const auto found = std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& kind) { return word == kind.first; });
    if (found == kKinds.end()) {
      const std::string nearest = config::Nearest(word, known);
      throw base::UsageError("products.kinds = \"" + kinds + "\" is not allowed: there is no kind \"" + word + "\"" +
                             (nearest.empty() ? "" : ", did you mean \"" + nearest + "\"?") +
                             ". Give auto, all, or some of ortho, dsm, terrain, buildings, video and elevations, separated by commas");
    }
    made.*(found->second) = true;
    begin = end + 1;
  }
  made.terrain = made.terrain || made.buildings;
  return made;
}

std::string NamesOf(const ProductKinds& kinds) {
  std::vector<std::string> names;
  if (kinds.ortho) names.emplace_back("orthophoto");
  if (kinds.dsm) names.emplace_back("surface model");
  if (kinds.terrain) names.emplace_back("terrain");
  if (kinds.buildings) names.emplace_back("buildings");
  if (kinds.elevations) names.emplace_back("elevations of walls");
  if (kinds.video) names.emplace_back(kinds.along_cameras ? "video along the cameras" : "video");
  return names.empty() ? "nothing" : base::Join(names, ", ");
}

}  // namespace skyquilt::products
