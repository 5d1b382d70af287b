#include "evaluate/page/geo_section.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {

namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// "0.30 ± 0.05 s"; the uncertainty is left out when unknown, and without a value there is an en dash.
std::string WithSigma(double value, double sigma, int decimals, const char* unit) {
  if (!std::isfinite(value) || !std::isfinite(sigma)) return FormatFixed(value, decimals, unit);
  return FormatFixed(value, decimals) + " \xC2\xB1 " + FormatFixed(sigma, decimals, unit);
}

std::string ScaleBarsText(const survey::GeoFit& fit) {
  std::string text;
  for (const survey::ScaleBarFit& bar : fit.scale_bars) {
    text += fmt::format(" {} to {}: {} measured on site, {} here.", EscapeHtml(bar.a), EscapeHtml(bar.b), FormatFixed(bar.length_m, 3, "m"),
                        FormatFixed(bar.measured_m, 3, "m"));
  }
  return text;
}

std::string FittedLead(const survey::Survey& survey) {
  const survey::GeoFit& fit = survey.fit;
  std::string html;
  if (survey.control.placed) {
    html += "The model was placed on Earth by its <a href=\"#control\">control points</a>; the GPS tags are only compared with it.";
  } else if (FrameIsExact(fit)) {
    html += "The frame is known exactly from the simulation: nothing was fitted, and the GPS tags are only compared with it.";
  } else {
    html +=
        "The model was placed on Earth by one similarity transform (scale, rotation, shift), from the GPS tags and from evidence for the direction "
        "of gravity.";
    if (fit.adjusted_to_tags) html += " Its shape is that of a bundle adjustment with the tags.";
  }
  if (fit.n_inliers > 0) {
    html += fmt::format(" RMSE against the tags {} over {} of {} tagged photos: {} horizontal, {} vertical.", FormatFixed(fit.rmse_m, 2, "m"),
                        fit.n_inliers, fit.n_matches, FormatFixed(fit.rmse_horizontal_m, 2, "m"), FormatFixed(fit.rmse_vertical_m, 2, "m"));
  }
  return Lead(html +
              fmt::format(" Coordinates are metres east, north and up of the origin at latitude {}, longitude {}, height {}.",
                          FormatFixed(survey.origin.latitude_deg, 6, kDegree), FormatFixed(survey.origin.longitude_deg, 6, kDegree),
                          FormatFixed(survey.origin.height_m, 1, "m")) +
              (fit.scale_bars.empty() ? "" : " Scale bars are compared with it." + ScaleBarsText(fit)));
}

std::string LocalLead(const survey::Survey& survey) {
  std::string html =
      survey.fit.scale_bars.empty()
          ? Lead(
                "There is no geo-reference: positions are in a levelled local frame of unknown scale. Lengths are not metres, and no direction is "
                "north.")
          : Lead(
                "There is no geo-reference: positions are in a levelled local frame. Lengths are metres by the scale bars, and no direction is "
                "north." +
                ScaleBarsText(survey.fit));
  std::string reasons;
  for (const survey::Problem& problem : survey.problems) {
    if (problem.about_place) reasons += "<li>" + EscapeHtml(problem.finding) + ".</li>";
  }
  if (reasons.empty()) return html;
  return html + "<div class=\"card prose\"><h3>Why</h3><ul>" + reasons + "</ul></div>\n";
}

void AddAccuracyRows(const geo::PlaceAccuracy& accuracy, FigureTable* table) {
  table->Group("Accuracy of the place, one standard deviation");
  table->Row("Scale", TwoDigits(accuracy.scale_percent, "%"),
             fmt::format("Of every length. 100 m on the map may be wrong by {}.", TwoDigits(accuracy.scale_percent, "m")));
  table->Row("Tilt", TwoDigits(accuracy.tilt_deg, kDegree),
             fmt::format("Between the map's up and the true one. Over 100 m, heights may rise or fall by {}.",
                         TwoDigits(100.0 * std::tan(accuracy.tilt_deg * kRadPerDeg), "m")));
  table->Row("Yaw", TwoDigits(accuracy.yaw_deg, kDegree),
             fmt::format("Rotation about the vertical. 100 m away from the survey's middle it shifts a point by {}.",
                         TwoDigits(100.0 * std::tan(accuracy.yaw_deg * kRadPerDeg), "m")));
  table->Row("Horizontal position", TwoDigits(accuracy.horizontal_m, "m"), "Of the survey's middle, east and north together.");
  table->Row("Vertical position", TwoDigits(accuracy.vertical_m, "m"), "Of the survey's middle, in the height system of the tags.");
}

void AddCorrectionRows(const survey::Survey& survey, FigureTable* table) {
  const survey::GeoFit& fit = survey.fit;
  const bool lag_known = std::isfinite(fit.tag_lag_sigma_s);
  table->Group("What was corrected");
  std::string lag_meaning = "Not estimated: the tags are taken to show where each photo was.";
  if (lag_known || fit.tag_lag_s != 0.0) {
    lag_meaning = "The tags show the position of this time before the photo.";
    if (std::isfinite(survey.checks.speed_mps)) {
      lag_meaning = fmt::format("The tags show the position of this time before the photo. At the flight's speed of {} that is {} along the track.",
                                FormatFixed(survey.checks.speed_mps, 1, "m/s"), FormatFixed(fit.tag_lag_s * survey.checks.speed_mps, 1, "m"));
    }
  }
  table->Row("Lag of the tags", lag_known || fit.tag_lag_s != 0.0 ? WithSigma(fit.tag_lag_s, fit.tag_lag_sigma_s, 2, "s") : "none", lag_meaning);
  const auto range = [](const std::vector<double>& values) { return values.empty() ? "none" : RangeOf(values, 2, "m"); };
  table->Row("Offset of tagged heights", range(fit.flight_vertical_offset_m), "Added to the tagged heights of a flight, at its middle.");
  table->Row("Drift of tagged heights", range(fit.flight_vertical_drift_m),
             "Rise of the tagged heights from the first to the last photo of a flight, taken out of them.");
  table->Row("Scale", fmt::format("{:.5g}\xE2\x80\xAFm", fit.scale), "Length of one unit of the COLMAP model.");
}

void AddCheckRows(const survey::FlightChecks& checks, FigureTable* table) {
  table->Group("Flight checks");
  std::string smear = "Motion of the picture while the sensor is read out. Unknown without the speed and the read-out time of the camera.";
  if (checks.readout_ms == 0.0) {
    smear = fmt::format("{} has a global or mechanical shutter: all rows are taken at once.",
                        checks.camera_name.empty() ? "The camera" : checks.camera_name);
  } else if (std::isfinite(checks.smear_px)) {
    smear = fmt::format(
        "Motion of the picture at full size while the sensor is read out: {}{} and {}{}. Several pixels bend the model: fly slower or higher.",
        FormatFixed(checks.speed_mps, 1, "m/s"), checks.speed_source.empty() ? "" : " (from " + checks.speed_source + ")",
        FormatFixed(checks.readout_ms, 0, "ms"), checks.camera_name.empty() ? "" : " (" + checks.camera_name + ")");
  }
  table->Row("Rolling shutter", FormatFixed(checks.smear_px, 1, "px"), smear);
  table->Row("Doming", WithSigma(checks.dome_m, checks.dome_sigma_m, 2, "m"),
             "Height of the middle of the camera positions above their edge, against the tags. Beyond three times its uncertainty the model is bent: "
             "add oblique photos.");
  table->Row("Lens distortion k1", WithSigma(checks.k1, checks.k1_sigma, 4, ""),
             "First radial coefficient of the camera with most photos. A large uncertainty lets the model dome.");
}

bool AnyCheck(const survey::FlightChecks& checks) {
  return std::isfinite(checks.smear_px) || std::isfinite(checks.dome_m) || std::isfinite(checks.k1) || std::isfinite(checks.readout_ms);
}

// Flights with corrections of their own.
std::string FlightTable(const survey::Survey& survey) {
  const std::vector<double>& offset_m = survey.fit.flight_vertical_offset_m;
  const std::vector<double>& drift_m = survey.fit.flight_vertical_drift_m;
  const size_t n_flights = std::max(offset_m.size(), drift_m.size());
  if (n_flights < 2) return "";
  std::vector<int64_t> n_photos(n_flights, 0), n_used(n_flights, 0);
  for (const survey::Photo& photo : survey.photos) {
    const auto flight = static_cast<size_t>(photo.flight);
    if (photo.flight < 0 || flight >= n_flights) continue;
    ++n_photos[flight];
    n_used[flight] += photo.gps_inlier ? 1 : 0;
  }
  const auto metres = [](const std::vector<double>& values, size_t i) {
    const double value = i < values.size() ? values[i] : kNotMeasured;
    return FixedCell(value, 2, "m");
  };
  std::string html =
      TableBegin(Headings({"Flight"}) + NumberHeadings({"Photos", "Tags used", "Offset of tagged heights", "Drift of tagged heights"}));
  for (size_t i = 0; i < n_flights; ++i) {
    html +=
        fmt::format("<tr><td>{}</td>", i + 1) + CountCell(n_photos[i]) + CountCell(n_used[i]) + metres(offset_m, i) + metres(drift_m, i) + "</tr>";
  }
  return html + kTableEnd + "\n";
}

}  // namespace

bool FrameIsExact(const survey::GeoFit& fit) {
  const geo::PlaceAccuracy& accuracy = fit.accuracy;
  return fit.gravity.empty() && accuracy.scale_percent == 0.0 && accuracy.tilt_deg == 0.0 && accuracy.yaw_deg == 0.0 &&
         accuracy.horizontal_m == 0.0 && accuracy.vertical_m == 0.0;
}

std::string GeoSection(const ReportInput& input) {
  const survey::Survey& survey = *input.survey;
  std::string html = SectionBegin("geo", "Geo-reference");
  html += survey.georeferenced ? FittedLead(survey) : LocalLead(survey);
  const bool fitted = survey.georeferenced && !FrameIsExact(survey.fit);
  FigureTable table;
  if (fitted) {
    AddAccuracyRows(survey.fit.accuracy, &table);
    AddCorrectionRows(survey, &table);
  }
  if (fitted || (!survey.georeferenced && AnyCheck(survey.checks))) {
    AddCheckRows(survey.checks, &table);
    html += table.Html();
  }
  html += GeoMap(survey) + GeoCharts(survey) + GravityEvidenceTable(survey);
  if (fitted) html += FlightTable(survey);
  return html + DirectionsTable(survey) + ResidualTable(survey) + "</section>\n";
}

}  // namespace skyquilt::evaluate::page
