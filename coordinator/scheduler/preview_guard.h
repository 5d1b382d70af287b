// Previews are a courtesy: nothing ends because one cannot be made.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "coordinator/project/project.h"
#include "coordinator/project/settings.h"

namespace skyquilt::coordinator {

// Calls make with the folder of the products, unless previews are not wanted or the orthophoto is there. What goes wrong is a warning: `what` is
// missing. Throws base::Interrupted only.
void AsPreview(const Settings& settings, const Project& project, const std::string& what,
               const std::function<void(const std::filesystem::path& folder)>& make);

}  // namespace skyquilt::coordinator
