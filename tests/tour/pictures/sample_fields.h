// Fields that tests make pictures of.
#pragma once

#include <functional>
#include <memory>

#include "tests/products/analytic_scene.h"
#include "tests/support/temporary_folder.h"
#include "tests/viewer/engine/whole_scene.h"
#include "tour/pictures/render_picture.h"

namespace skyquilt::tour {

// A plane with a house, known exactly, which counts the rays that it is asked for.
struct CountedField {
  CountedField() {
    field.identity = "a plane with a house";
    field.batch_rays = 1000;
    field.caster = [this](const std::string& exposure) -> products::RayCaster {
      const float brightness = exposure == "normal" ? 1.0F : 0.5F;
      return [this, brightness](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
        products::AnalyticScene().Caster()(rays, out);
        for (render::RayColor& color : out) {
          for (float& value : color.rgb_srgb) value *= brightness;
        }
        n_rays += static_cast<int64_t>(rays.size());
        if (after_batch) after_batch();
      };
    };
  }
  CountedField(const CountedField&) = delete;
  CountedField& operator=(const CountedField&) = delete;

  PictureField field;
  int64_t n_rays = 0;
  std::function<void()> after_batch;
};

// A scene file, loaded.
struct SceneField {
  explicit SceneField(const viewer::WholeScene& what) {
    viewer::WriteWholeScene(folder / "scene.h5", what);
    scene = std::make_unique<scene::Scene>(scene::Scene::Load(folder / "scene.h5"));
    field = FieldOf(*scene, folder / "scene.h5", false, threads);
  }

  TemporaryFolder folder;
  base::ThreadPool threads{2};
  std::unique_ptr<scene::Scene> scene;
  PictureField field;
};

}  // namespace skyquilt::tour
