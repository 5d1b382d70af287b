// Variants that are not trained.
#include "bench/study/study.h"
#include "core/base/file.h"
#include "core/base/log.h"

namespace skyquilt::bench {

VariantResult Study::RunUntrained(const Variant& variant, const UntrainedWork& work) {
  const coordinator::Settings settings = SettingsOf(variant);
  const std::string identity = Identity(variant, settings) + " untrained";
  if (std::optional<VariantResult> known = Load(variant, identity)) {
    base::LogInfo("{}: nothing to do, its result is saved", variant.label);
    return *std::move(known);
  }
  base::LogInfo("--- {}", variant.label);
  coordinator::Pipeline pipeline = BeginRun(variant, settings, false);
  VariantResult result;
  result.name = variant.name;
  result.label = variant.label;
  work(pipeline, &result);
  if (variant.AllPhotos()) LinkPixels(pipeline.project.folder, settings.run.image_width, true);
  base::WriteFileAtomically(RunFolder(variant).string() + ".json", ResultJson(result, identity));
  if (!options_.keep) RemoveLargeFiles(variant);
  return result;
}

}  // namespace skyquilt::bench
