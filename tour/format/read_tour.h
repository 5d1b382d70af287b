// Reads tour.json. There are two ways: strictly, before it is saved, and so that as much as possible of it can be played.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/checked_json.h"
#include "tour/format/tour.h"

namespace skyquilt::tour {

// Everything must be as docs/tour_format.md says. Throws base::Refused with the path of the member that is wrong and the rule that it breaks.
Tour ParseTour(std::string_view text);

struct PlayableTour {
  Tour tour;                         // every reference leads somewhere, every asset is there
  std::vector<std::string> missing;  // plain sentences in English: what was left out, by name. Titles of stops in it are plain text, too
};

// Whether an asset of this name and length is there.
using HasAsset = std::function<bool(const std::string& name, uint64_t bytes)>;

// Leaves out what cannot be played: members and kinds that are not known, references that lead nowhere, assets that are not there; of a file of
// another version all that cannot be read. Throws base::Refused for a damaged file.
PlayableTour ReadTourToPlay(std::string_view text, const HasAsset& has_asset);

}  // namespace skyquilt::tour
