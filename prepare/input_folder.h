// What kind of folder a person handed over, and where its pieces lie.
#pragma once

#include <filesystem>
#include <optional>

#include "core/geo/geodetic.h"
#include "core/survey/survey.h"

namespace skyquilt::prepare {

struct InputFolder {
  std::filesystem::path photo_root;           // absolute
  std::filesystem::path model;                // empty: COLMAP has to be run
  std::filesystem::path masks;                // empty: none
  std::optional<geo::Geodetic> exact_origin;  // simulated survey whose model already is in ENU about this origin
  std::optional<survey::Truth> truth;         // simulated survey
};

// `photos` may be a folder of photos, one with the photos in images/, or a simulate folder (simulate.json). `model` and `masks` are what the
// person asked for; empty means: look in the usual place (a model only in simulate folders, masks in PHOTOS/masks).
// Throws base::InputError: no such folder, damaged simulate.json.
InputFolder FindInputs(const std::filesystem::path& photos, const std::filesystem::path& model, const std::filesystem::path& masks);

}  // namespace skyquilt::prepare
