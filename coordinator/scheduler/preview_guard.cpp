#include "coordinator/scheduler/preview_guard.h"

#include "core/base/errors.h"
#include "core/base/log.h"
#include "products/preview_files.h"

namespace skyquilt::coordinator {

void AsPreview(const Settings& settings, const Project& project, const std::string& what,
               const std::function<void(const std::filesystem::path& folder)>& make) {
  try {
    const std::filesystem::path folder = project.ProductsFolder();
    if (settings.products.preview && !products::HasOrthophoto(folder)) make(folder);
  } catch (const base::Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    base::LogWarning("there is no {}: {}", what, error.what());
  }
}

}  // namespace skyquilt::coordinator
