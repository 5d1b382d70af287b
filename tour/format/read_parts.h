// The parts of reading a tour that its two ways share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tour/format/fields.h"
#include "tour/format/read_tour.h"
#include "tour/format/tour.h"

namespace skyquilt::tour {

// All members with their types and limits, without what they refer to. Reads the version first and sets reading->other_version.
Tour ReadMembers(std::string_view text, Reading* reading);

// Throws base::Refused for an id that occurs twice, and for a reference to a stop or an asset that is not there.
void CheckReferences(const Tour& tour);

// Leaves them out instead, with a sentence each.
void LeaveOutDangling(Tour* tour, const HasAsset& has_asset, std::vector<std::string>* missing);

}  // namespace skyquilt::tour
