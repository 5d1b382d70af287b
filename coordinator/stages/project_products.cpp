#include "coordinator/stages/project_products.h"

#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/scene/scene.h"
#include "products/camera_path.h"
#include "products/map_products.h"
#include "products/render_views.h"

namespace skyquilt::coordinator {

void MakeProjectProducts(const Project& project, const products::ProductOptions& options, SceneSession& session) {
  const scene::Scene& scene = session.scene();
  base::ThreadPool& threads = session.threads();
  std::filesystem::create_directories(project.ProductsFolder());
  if (options.ortho || options.dsm) {
    const products::MapProducts maps = products::MakeMapProducts(scene, options, project.ProductsFolder(), threads);
    spdlog::info("map of {} x {} cells of {:.3g} m, {:.0f} % filled: {}", maps.grid.width, maps.grid.height, maps.grid.resolution_m,
                 100.0 * maps.filled, project.ProductsFolder().string());
  }
  if (options.video_seconds > 0.0) {
    const std::filesystem::path file = project.ProductsFolder() / (options.video_path + ".mp4");
    const products::RenderStats stats =
        products::RenderVideo(products::RendererOf(scene, products::AppearanceOf(options.exposure, scene.info()), threads),
                              products::BuiltInPath(scene.info(), options), options.video_fps, file);
    spdlog::info("video of {} frames, {} rays/s: {}", stats.views, base::FormatCount(stats.RaysPerSecond()), file.string());
  }
}

}  // namespace skyquilt::coordinator
