// report/index.html: one page that opens offline; style and script inside, pictures as files beside it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/train_report.h"
#include "core/survey/survey.h"
#include "evaluate/control/control_pictures.h"
#include "evaluate/metrics/metrics.h"
#include "evaluate/metrics/training_curve.h"
#include "evaluate/page/brightness_report.h"
#include "evaluate/page/drawn_map.h"
#include "evaluate/page/elevation_section.h"
#include "evaluate/page/input_files.h"
#include "evaluate/page/masks_section.h"
#include "evaluate/page/ortho_section.h"
#include "partition/block.h"

namespace skyquilt::evaluate::buildings {
struct BuildingsReport;
}

namespace skyquilt::evaluate::page {

// Pictures of one held-out photo; paths relative to the page, empty when not written.
struct PhotoImages {
  std::string photo, render, error, depth;
  std::string normals, true_normals;  // of rendering and truth
  std::string trust;                  // error that trust expects
  std::string mesh;                   // the surface's mesh as the photo would show it
  int width = 0;                      // pixels
  int height = 0;
  double depth_low_m = kNotMeasured;  // range of the depth colours
  double depth_high_m = kNotMeasured;

  // All paths; empty ones are not shown.
  std::array<std::string, 8> Files() const { return {photo, render, error, depth, normals, true_normals, trust, mesh}; }
};

struct ReportInput {
  std::string title;  // name of the project
  const metrics::Metrics* metrics = nullptr;
  const survey::Survey* survey = nullptr;
  const partition::BlockSet* blocks = nullptr;
  const scene::TrainReport* training = nullptr;           // without fields when it is unknown
  metrics::Curves curves;                                 // of its fields
  const BrightnessReport* brightness = nullptr;           // nothing or empty: no such section
  const buildings::BuildingsReport* buildings = nullptr;  // nothing: no such section
  InputFiles files;                                       // of the photo folder
  MasksReport masks;                                      // and what moved; none: no such section
  std::vector<PhotoImages> images;                        // entry i belongs to metrics->photos[i]
  std::vector<control::MarkPicture> mark_pictures;        // of the survey's control points, in their order
  std::optional<MapBackground> background;
  std::vector<OrthoPicture> ortho_pictures;  // none without a true map
  std::vector<ElevationPicture> elevations;  // none: no such section
  std::string color_ramp;                    // picture of the colour map from low to high, relative to the page; empty: no legend
  double error_high = 0.25;                  // display values at the top of the error colours
};

std::string BuildReportPage(const ReportInput& input);

}  // namespace skyquilt::evaluate::page
