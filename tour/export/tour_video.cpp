#include "tour/export/tour_video.h"

#include <map>
#include <vector>

#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/image/video_writer.h"
#include "tour/ways/film.h"

namespace skyquilt::tour {
namespace {

bool IsSame(const PictureRequest& a, const PictureRequest& b) {
  return a.eye_enu == b.eye_enu && a.cam_from_enu.coeffs() == b.cam_from_enu.coeffs() && a.fovy_deg == b.fovy_deg && a.exposure == b.exposure;
}

}  // namespace

void WriteTourVideo(const Tour& tour, const Heights* heights, const PictureField& field, const VideoSpec& spec, const std::filesystem::path& file) {
  const std::vector<FilmFrame> frames = FilmOf(tour, heights, spec.fps);
  std::map<std::string, products::RayCaster> casters;
  std::vector<PictureRequest> requests;
  for (const FilmFrame& frame : frames) {
    const std::string exposure = ExposureText(tour.stops[frame.stop].exposure_stops, spec.exposure);
    if (!casters.contains(exposure)) casters[exposure] = field.caster(exposure);
    requests.push_back(StillAt(frame.pose.eye_enu, frame.pose.cam_from_enu, frame.pose.fovy_deg, spec.width, spec.height, exposure));
  }
  image::VideoWriter video(file, spec.width, spec.height, spec.fps);
  base::Progress progress("video of the tour", static_cast<double>(frames.size()), "frames");
  image::Image8 shown;
  for (size_t i = 0; i < requests.size(); ++i) {
    if (i == 0 || !IsSame(requests[i], requests[i - 1])) {
      shown = RenderPicture(requests[i], field, casters.at(requests[i].exposure), [](int64_t) {}).color;
    }
    video.Write(shown);
    progress.Advance();
  }
  video.Close();
  progress.Finish();
  base::LogInfo("video of the tour: {:.0f} s", static_cast<double>(frames.size()) / spec.fps);
}

}  // namespace skyquilt::tour
