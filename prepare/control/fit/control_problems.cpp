#include "prepare/control/fit/control_problems.h"

#include <cmath>

#include "core/base/log.h"
#include "core/base/text.h"

namespace skyquilt::prepare::control {
namespace {

std::string LineOf(const ControlPoint& point) {
  return point.line > 0 ? " (line " + std::to_string(point.line) + ")" : "";
}

survey::Problem WrongPoint(const ControlPoints& control, const ControlPoint& given, const survey::ControlPointFit& point) {
  const Eigen::Vector3d& error = point.error_m;
  std::string by = fmt::format("{:+.2f} m east, {:+.2f} m north", -error.x(), -error.y());
  if (std::isfinite(error.z())) by += fmt::format(", {:+.2f} m up", -error.z());
  const double distance = std::isfinite(error.z()) ? error.norm() : error.head<2>().norm();
  return {"control_point_wrong",
          fmt::format("Control point '{}' contradicts the others: its coordinates are off by {:.2f} m ({}) from where its marks are", given.label,
                      distance, by),
          fmt::format("It is not used. Check its coordinates in {}{} and whether its marks show another point", control.file, LineOf(given)), false};
}

survey::Problem WrongMarks(const ControlPoints& control, const std::vector<std::string>& marks) {
  constexpr size_t kShown = 10;
  const std::vector<std::string> shown(marks.begin(), marks.begin() + static_cast<std::ptrdiff_t>(std::min(marks.size(), kShown)));
  return {"control_mark_wrong",
          fmt::format("{} {} the other marks of the same point: {}{}", marks.size(), marks.size() == 1 ? "mark contradicts" : "marks contradict",
                      base::Join(shown), marks.size() > kShown ? ", ..." : ""),
          "They are not used. Correct them in " + control.file, false};
}

survey::Problem NoAdjustment(NotAdjusted why) {
  const char* finding = "The survey was moved to the control points as a whole, but not bent to fit them, because ";
  switch (why) {
    case NotAdjusted::kUnknownLens:
      return {"control_not_adjusted", std::string(finding) + "its lens model is one that the adjustment does not know",
              "Expect errors between the control points. Reconstruct with the lens model OPENCV, or adjust with control points in the other program",
              false};
    case NotAdjusted::kNoSolution:
      return {"control_not_adjusted", std::string(finding) + "the bundle adjustment found no solution",
              "Check marks and coordinates of the control points", false};
    default:
      return {"control_not_adjusted", std::string(finding) + "its model has no features that photos share",
              "Expect errors between the control points. Give a COLMAP model with observations, or leave out --model", false};
  }
}

}  // namespace

NoControl WhyNoControl(SimilarityFailure failure, const std::vector<std::string>& usable) {
  if (failure == SimilarityFailure::kOnLine) {
    return {"the control points that can be used are all on one line (" + base::Join(usable) + "), which leaves the turn about it open",
            "Give at least one more control point beside the line, with marks on two photos or more"};
  }
  return {fmt::format("only {} control point{} can be used{}{}, three are needed to place the survey", usable.size(), usable.size() == 1 ? "" : "s",
                      usable.empty() ? "" : ": ", base::Join(usable)),
          "A control point needs a height and marks that agree on two photos with a pose or more, and must not be a check point. "
          "Marks that were made in turned pictures need photos with their EXIF orientation"};
}

std::vector<survey::Problem> ControlProblems(const ControlPoints& control, const survey::ControlFit& fit, NotAdjusted not_adjusted, double misfit) {
  std::vector<survey::Problem> problems;
  std::vector<std::string> marks, unseen;
  for (size_t i = 0; i < fit.points.size(); ++i) {
    const survey::ControlPointFit& point = fit.points[i];
    if (point.use == survey::ControlUse::kRejected) problems.push_back(WrongPoint(control, control.points[i], point));
    if (point.use == survey::ControlUse::kUnseen) unseen.push_back(point.label + LineOf(control.points[i]));
    for (const survey::ControlMarkFit& mark : point.marks) {
      if (mark.used || !std::isfinite(mark.error_px) || point.use == survey::ControlUse::kUnseen) continue;
      marks.push_back(fmt::format("'{}' on {} ({:.1f} px off)", point.label, mark.photo, mark.error_px));
    }
  }
  constexpr double kMaxMisfit = 3.0;
  if (misfit > kMaxMisfit) {
    problems.push_back({"control_disagrees",
                        fmt::format("The control points miss each other's predictions by {:.1f} times what their accuracies allow", misfit),
                        "The stated accuracies were enlarged by this. Check the accuracies and the coordinate system of " + control.file +
                            ", and whether several points or marks are wrong",
                        true});
  }
  if (!marks.empty()) problems.push_back(WrongMarks(control, marks));
  if (not_adjusted != NotAdjusted::kNo) problems.push_back(NoAdjustment(not_adjusted));
  if (!unseen.empty()) {
    problems.push_back({"control_point_unseen", "No place could be computed for points without two marks that agree: " + base::Join(unseen),
                        "Mark them on more photos, or correct their marks", false});
  }
  return problems;
}

}  // namespace skyquilt::prepare::control
