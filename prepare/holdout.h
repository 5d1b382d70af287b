// Chooses the photos that are kept for testing. They are not trained on, so that rendering them measures the quality of the scene.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/survey/survey.h"

namespace skyquilt::prepare {

struct Holdout {
  int every = 0;               // every how many photos one is held out; 0: not by index
  int offset = 0;              // in [0, every)
  std::filesystem::path list;  // file with one name per line; empty: not by name
};

// Reads "none", "every:N", "every:N:offset" or "list:FILE". Throws base::UsageError for anything else.
Holdout ParseHoldout(const std::string& text);
// Sets is_test of every photo. The index counts the photos with a pose in name order: index % every == offset is held out, as usual in NeRF
// benchmarks. Throws base::InputError for a list that cannot be read or names an unknown photo, base::UsageError if no photo remains to train on.
void MarkHoldout(const Holdout& holdout, survey::Survey& survey);

// The same with photos of one shot (the cameras of a rig, the views of a panorama) held out together, or none of them: neighbours show nearly the
// same. Each shot counts as one photo with its name. A list may name shots, or any of their photos. `shot_of_photo`: by names of photos; those that
// are not in it stand alone.
void MarkHoldout(const Holdout& holdout, const std::map<std::string, std::string>& shot_of_photo, survey::Survey& survey);

}  // namespace skyquilt::prepare
