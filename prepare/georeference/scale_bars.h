// prepare.scale_bars: lengths that were measured on site. Photos alone leave the scale of a reconstruction open; one length between two places that
// are marked in photos, or between two points of the model, gives it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/survey/colmap_model.h"
#include "prepare/control/reading/control_points.h"
#include "prepare/control/reading/read_control.h"
#include "prepare/georeference/georeference.h"
#include "prepare/input/photo_files.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

struct ScaleBar {
  std::string a, b;       // labels of marks, or points as they were given
  double length_m = 0.0;  // > 0
  // The two points in the frame that the model had when it was read; nothing: marks.
  std::optional<Eigen::Vector3d> at_a = {}, at_b = {};
};

// Of an option "A,B,LENGTH|A,B,LENGTH"; A and B are both labels, or both x;y;z. Throws base::UsageError that says how to write them.
std::vector<ScaleBar> ParseScaleBars(const std::string& text);

// The marks of the bars' labels: those of the control points, or of the file of marks alone where there is none. Empty when no bar has labels. Throws
// base::UsageError for a label without marks in two photos, and as ReadControl does.
control::ControlPoints ReadScaleMarks(const std::vector<ScaleBar>& bars, const control::ControlFiles& given, const control::ControlPoints& control,
                                      const std::vector<input::PhotoFile>& files);

// Scales the local frame of a survey without a place so that its lengths are metres: least squares over the bars; the accuracy of the scale comes
// from what they disagree, and is at least kLeastBarError_percent of one. A survey with a place is only compared. Both are logged and kept in
// Georeference::fit; bars that differ by more than kBarConflict_percent become a problem, and so do bars none of which can be measured. `model` and
// `photos` are in the geo-reference's model frame. Does nothing without bars.
void ApplyScaleBars(const std::vector<ScaleBar>& bars, const control::ControlPoints& marks, survey::ColmapModel& model,
                    const std::vector<input::PreparedPhoto>& photos, Georeference& georeference);

constexpr double kBarConflict_percent = 5.0;
constexpr double kLeastBarError_percent = 0.5;

}  // namespace skyquilt::prepare::georeference
