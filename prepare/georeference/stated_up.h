// prepare.up: the direction of up by the user, where photos, tags and points cannot tell it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

// Throws base::UsageError unless `text` is empty, "cameras", or x,y,z of a direction in the model's frame (any length above 0).
void CheckUpOption(const std::string& text);
// Up in the model's frame, a unit vector; nothing for an empty text. "cameras": the mean of the photos' own up. Throws as CheckUpOption does, and
// where the cameras' up directions cancel.
std::optional<Eigen::Vector3d> StatedUp(const std::string& text, const std::vector<input::PreparedPhoto>& photos);

}  // namespace skyquilt::prepare::georeference
