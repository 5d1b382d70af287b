// Several folders of photos as one survey: zones, or flights of several days.
#pragma once

#include <filesystem>
#include <vector>

namespace skyquilt::prepare::input {

// Makes `folder` hold a link to each zone and nothing else, so that it can be given as the folder of the photos, whose names begin with that of their
// zone: the name of its folder, with that of the folder above before it where two zones have the same. Returns `folder`. Throws base::InputError for
// a zone that is no folder, base::UsageError for one that is given twice or inside another or has the other's name, too, and for a
// `folder` inside of one.
std::filesystem::path LinkZones(const std::vector<std::filesystem::path>& zones, const std::filesystem::path& folder);

// The same with zones beside those of an earlier survey, whose links keep their names. `earlier`: the folder of its photos, `folder` itself or one
// without zones. Zones that are there already are not added again. Returns the folder of all photos: `earlier` when there is nothing to add to it.
std::filesystem::path AddZones(const std::filesystem::path& earlier, const std::vector<std::filesystem::path>& zones,
                               const std::filesystem::path& folder);

}  // namespace skyquilt::prepare::input
