#include "coordinator/project/settings.h"

#include "core/base/errors.h"

namespace skyquilt::coordinator {

config::Sections Settings::AllSections() {
  config::Sections sections;
  sections.Add("run", run, "options of all stages from photos to report");
  sections.Add("simulate", simulate, "surveys with ground truth, made by 'skyquilt simulate'");
  sections.Add("prepare", prepare, "from photos to a geo-referenced survey");
  sections.Add("masks", masks, "masks that are made of the survey: of what moves, and of ground to ignore");
  sections.Add("partition", partition, "division of the survey into blocks");
  sections.Add("brightness", brightness, "correction of exposure differences between photos");
  sections.Add(
      "context", context,
      "the coarse field of the whole survey: every option of [train] may be given here too; what is not given is as there, but for steps and "
      "seconds");
  sections.Add("train", train, "the fine field of each block");
  sections.Add("priors", priors, "what the blocks are taught about surfaces beside the photos");
  sections.Add("robust", robust, "pixels of photos that the blocks do not learn from, because other photos contradict them");
  sections.Add("trust", trust, "what is known about the errors of the scene, place by place");
  sections.Add("merge", merge, "how blocks are joined into one scene");
  sections.Add("products", products, "orthophoto, surface model, images, video");
  sections.Add("surface", surface, "mesh, point cloud, 3D tiles and terrain of the scene");
  sections.Add("buildings", buildings, "buildings of the surface with their measures");
  sections.Add("tour", tour, "tours that are given away as a folder");
  sections.Add("evaluate", evaluate, "scores and report");
  // Both fields divide one budget: what a block may cost says nothing about the context.
  sections.Inherit("context", "train", {"steps", "seconds"}, named_in_context);
  sections.Rename("simulate.preset", "simulate.place");
  sections.Retire("run.context_ranks", "rank 0 trains the context alone");
  return sections;
}

std::string Settings::Toml() const {
  Settings copy = *this;
  return config::WriteToml(copy.AllSections());
}

FlatOptions Settings::Flat() const {
  Settings copy = *this;
  return config::Flatten(copy.AllSections());
}

void Settings::Set(const config::Override& entry) {
  config::ApplyOverride(entry, AllSections());
}

void Settings::Check() const {
  Settings copy = *this;
  copy.AllSections().Check();
  if (run.time_budget_s > 0.0 && train.steps > 0) {
    throw base::UsageError("both a time budget (run.time_budget_s = " + std::to_string(run.time_budget_s) +
                           ") and a number of steps (train.steps = " + std::to_string(train.steps) +
                           ") are given. Choose one and set the other to 0");
  }
}

}  // namespace skyquilt::coordinator
