#include "prepare/control/fit/mark_reading.h"

#include "prepare/bundle/triangulate.h"
#include "prepare/control/fit/control_bundle.h"

namespace skyquilt::prepare::control {
namespace {

// Pixels of a photo of 1600 pixels width: right marks in a model that bends a little.
constexpr double kAgreeing = 6.0;

// Open marks that agree with others when `control` has the pixels of one reading. `job.control` says which are open.
size_t CountAgreeing(const ControlJob& job, const ControlPoints& control) {
  ControlBundle marked = MakeControlBundle({.model = job.model, .observations = job.observations, .photos = job.photos, .control = control});
  size_t n = 0;
  for (size_t i = 0; i < control.points.size(); ++i) {
    bundle::TriangulateTrack(marked.bundle, marked.TrackOfPoint(i), kAgreeing);
    for (size_t k = 0; k < control.points[i].marks.size(); ++k) {
      const std::optional<uint32_t> entry = marked.mark[i][k];
      if (job.control.points[i].marks[k].if_upright && entry && marked.bundle.agrees[*entry] != 0) ++n;
    }
  }
  return n;
}

}  // namespace

MarkReading ReadingVotes::Reading() const {
  constexpr size_t kLeast = 2;
  if (n_upright >= kLeast && n_upright > 2 * n_stored) return MarkReading::kUpright;
  if (n_stored >= kLeast && n_stored > 2 * n_upright) return MarkReading::kStored;
  return MarkReading::kUndecided;
}

ReadingVotes CountReadings(const ControlJob& job) {
  ReadingVotes votes;
  for (const ControlPoint& point : job.control.points) {
    for (const ControlMark& mark : point.marks) votes.n_open += mark.if_upright ? 1 : 0;
  }
  if (votes.n_open == 0) return votes;
  ControlPoints upright = job.control;
  Settle(MarkReading::kUpright, upright);
  votes.n_stored = CountAgreeing(job, job.control);
  votes.n_upright = CountAgreeing(job, upright);
  return votes;
}

void Settle(MarkReading reading, ControlPoints& control) {
  for (ControlPoint& point : control.points) {
    for (ControlMark& mark : point.marks) {
      if (reading == MarkReading::kUpright && mark.if_upright) mark.pixel = *mark.if_upright;
      mark.if_upright.reset();
    }
  }
}

}  // namespace skyquilt::prepare::control
