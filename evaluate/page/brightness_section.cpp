#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/page/curve_chart.h"
#include "core/page/figure.h"
#include "core/page/plot_frame.h"
#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"
#include "evaluate/page/time_axis.h"

namespace skyquilt::evaluate::page {

namespace {

constexpr double kAlikeStops = 0.05;  // tags that differ by less say nothing
constexpr size_t kManyDots = 400;
constexpr double kWide_px = 1160.0;  // of a drawing over the whole page

struct GainColor {
  const char* name;
  const char* css_class;
};
constexpr std::array<GainColor, 3> kGainColors = {{{"red", "c5"}, {"green", "c7"}, {"blue", "c1"}}};

// With a plus before what is above zero.
std::string SignedFixed(double value, int decimals, std::string_view unit = "") {
  const std::string text = FormatFixed(value, decimals, unit);
  return value > 0.0 && text.find_first_of("123456789") != std::string::npos ? "+" + text : text;
}

bool AllFinite(const BrightnessPhoto& photo) {
  return std::isfinite(photo.time_s + photo.exif_stops + photo.learned_stops[0] + photo.learned_stops[1] + photo.learned_stops[2]);
}

bool Learned(const BrightnessReport& brightness) {
  return std::any_of(brightness.photos.begin(), brightness.photos.end(), [](const BrightnessPhoto& photo) {
    return photo.learned_stops != std::array<double, 3>{0.0, 0.0, 0.0};
  });
}

// What the chart draws: one x and four y per photo, and the photos of each flight and camera in order.
struct GainSeries {
  std::vector<const BrightnessPhoto*> photos;
  std::vector<double> x, exif;
  std::array<std::vector<double>, 3> learned;  // tags and learned gains together
  std::map<int, std::vector<size_t>> groups;
  std::string x_label;
};

GainSeries SeriesOf(const BrightnessReport& brightness) {
  GainSeries series;
  std::vector<double> times_s;
  times_s.reserve(brightness.photos.size());
  for (const BrightnessPhoto& photo : brightness.photos) {
    if (!AllFinite(photo)) continue;
    series.groups[photo.group].push_back(series.photos.size());
    series.photos.push_back(&photo);
    times_s.push_back(photo.time_s);
    series.exif.push_back(photo.exif_stops);
    for (size_t c = 0; c < 3; ++c) series.learned[c].push_back(photo.exif_stops + photo.learned_stops[c]);
  }
  TimeAxis axis = brightness.timed ? AxisOfTimes(times_s) : AxisOfNames(times_s.size());
  series.x = std::move(axis.x);
  series.x_label = std::move(axis.label);
  return series;
}

PlotFrame GainFrame(const GainSeries& series) {
  PlotFrame frame{.title = "Exposure of the photos, 0 is the reference",
                  .x = {.label = series.x_label, .low = series.x.front(), .high = series.x.back(), .ticks = 10},
                  .y = {.label = "exposure (stops)", .low = -0.25, .high = 0.25},
                  .width_px = kWide_px,
                  .height_px = 320.0,
                  .css_class = "wide",
                  .zero_stands_out = true};
  for (const double x : series.x) frame.x.Include(x);
  for (const double stops : series.exif) frame.y.Include(stops);
  for (const std::vector<double>& learned : series.learned) {
    for (const double stops : learned) frame.y.Include(stops);
  }
  frame.x.Pad(frame.x.high > frame.x.low ? 0.01 * (frame.x.high - frame.x.low) : 0.5);
  frame.y.Pad(0.06 * (frame.y.high - frame.y.low));
  return frame;
}

// Photos of another flight or camera are not joined. Steps: a value holds until the next photo.
std::string GainPath(const PlotFrame& frame, const GainSeries& series, const std::vector<double>& y, bool steps, const char* css_class,
                     const std::string& title) {
  std::string path;
  for (const auto& group : series.groups) {
    for (size_t k = 0; k < group.second.size(); ++k) {
      const double x_px = frame.X(series.x[group.second[k]]), y_px = frame.Y(y[group.second[k]]);
      if (k == 0) {
        path += fmt::format("M{:.1f} {:.1f}", x_px, y_px);
      } else {
        path += steps ? fmt::format("H{:.1f}V{:.1f}", x_px, y_px) : fmt::format("L{:.1f} {:.1f}", x_px, y_px);
      }
    }
  }
  return SvgPath(fmt::format("curve {}", css_class), path, title);
}

std::string GainDots(const PlotFrame& frame, const GainSeries& series, size_t i, bool learned) {
  const BrightnessPhoto& photo = *series.photos[i];
  std::string html = fmt::format("<g class=\"at\"><title>{}{}\nEXIF {}", EscapeHtml(photo.name), photo.held_out ? " (held out)" : "",
                                 SignedFixed(photo.exif_stops, 2, "stops"));
  if (learned) {
    html += fmt::format("\nEXIF and {}: red {}, green {}, blue {}", photo.held_out ? "predicted" : "learned", SignedFixed(series.learned[0][i], 2),
                        SignedFixed(series.learned[1][i], 2), SignedFixed(series.learned[2][i], 2, "stops"));
  }
  html += "</title>";
  const double radius_px = series.photos.size() > kManyDots ? 1.4 : 2.4;
  const auto dot = [&](double y, const char* css_class) {
    html += fmt::format("<circle class=\"dot {}{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>", css_class, photo.held_out ? " hollow" : "",
                        frame.X(series.x[i]), frame.Y(y), radius_px);
  };
  if (learned) {
    for (size_t c = 0; c < 3; ++c) dot(series.learned[c][i], kGainColors[c].css_class);
  } else {
    dot(series.exif[i], "c6");
  }
  return html + "</g>";
}

std::string GainChart(const BrightnessReport& brightness) {
  const GainSeries series = SeriesOf(brightness);
  if (series.photos.empty()) return "";
  const PlotFrame frame = GainFrame(series);
  const bool learned = Learned(brightness);
  std::string html = PlotBegin(frame) + GainPath(frame, series, series.exif, true, "c6", "EXIF");
  std::string legend = LegendEntry("c6", "EXIF");
  for (size_t c = 0; learned && c < 3; ++c) {
    const std::string name = fmt::format("EXIF and learned, {}", kGainColors[c].name);
    html += GainPath(frame, series, series.learned[c], false, kGainColors[c].css_class, name);
    legend += LegendEntry(kGainColors[c].css_class, name);
  }
  for (size_t i = 0; i < series.photos.size(); ++i) html += GainDots(frame, series, i, learned);
  return html + FigureEnd(legend + LegendEntry("ring", "held-out photo"));
}

std::string BinsPath(const PlotFrame& frame, const BrightnessHistogram& shares, const char* css_class, const char* title) {
  std::string path = fmt::format("M{:.1f} {:.1f}", frame.X(0.0), frame.Y(0.0));
  for (size_t bin = 0; bin < shares.size(); ++bin) {
    path += fmt::format("V{:.1f}H{:.1f}", frame.Y(100.0 * shares[bin]), frame.X(static_cast<double>(bin + 1) / static_cast<double>(shares.size())));
  }
  return SvgPath(css_class, path + fmt::format("V{:.1f}Z", frame.Y(0.0)), title);
}

std::string HistogramChart(const BrightnessReport& brightness, bool alone) {
  const BrightnessHistogram &before = brightness.histogram_before, &after = brightness.histogram_after;
  const double most = std::max(*std::max_element(before.begin(), before.end()), *std::max_element(after.begin(), after.end()));
  if (!(most > 0.0)) return "";
  PlotFrame frame{.title = "Brightness of the training photos, before and after correction",
                  .x = {.label = "display value (0 black, 1 white)", .ticks = 10},
                  .y = {.label = "pixels (%)", .high = 100.0 * most * 1.06},
                  .zero_stands_out = true};
  if (alone) {
    frame.width_px = kWide_px;
    frame.height_px = 260.0;
    frame.css_class = "wide";
  }
  return PlotBegin(frame) + BinsPath(frame, after, "bins c0", "at reference exposure") + BinsPath(frame, before, "curve c6", "as recorded") +
         FigureEnd(LegendEntry("c6", "as recorded") + LegendEntry("c0", "at reference exposure"));
}

std::string VignettingChart(const BrightnessReport& brightness) {
  std::vector<Curve> curves;
  for (size_t camera = 0; camera < brightness.vignetting.size(); ++camera) {
    const VignettingCurve& shares = brightness.vignetting[camera];
    Curve& curve = curves.emplace_back();
    curve.name = fmt::format("camera {}", camera + 1);
    for (size_t i = 0; i < shares.size(); ++i) {
      curve.points.emplace_back(static_cast<double>(i) / static_cast<double>(shares.size() - 1), 100.0 * shares[i]);
    }
  }
  return CurveChart(
      curves, {.title = "Vignetting: light towards the corners", .x_label = "distance from the middle, 1 = farthest corner", .y_label = "light (%)"});
}

std::string TagSentences(const BrightnessReport& brightness, double low_stops, double high_stops) {
  const bool alike = high_stops - low_stops < kAlikeStops;
  std::string text = "The tags (shutter time, aperture, ISO) show no difference in exposure, or are not used. ";
  if (!alike) {
    text = fmt::format(
        "By their tags (shutter time, aperture, ISO) the photos were exposed between {} and {} from the reference. One stop more is twice the "
        "light. ",
        SignedFixed(low_stops, 2), SignedFixed(high_stops, 2, "stops"));
  }
  if (!Learned(brightness)) return text + "Nothing beyond the tags was learned. ";
  text += "Training learned a further gain per photo and colour. For held-out photos it is predicted from the photos before and after. ";
  if (alike) return text;
  const char* meaning = "the photos show only this part of the differences in the tags; the rest was changing light that the camera compensated";
  if (brightness.trust_in_tags >= 0.9) meaning = "the photos differ in brightness as their tags say";
  if (brightness.trust_in_tags <= 0.1) meaning = "the camera followed the changing light, so the photos are equally bright whatever their tags say";
  return text + fmt::format("Trust in the tags is {}: {}. ", FormatPercent(brightness.trust_in_tags, 0), meaning);
}

std::string SpreadSentences(const BrightnessReport& brightness) {
  const double before = brightness.spread_before_stops, after = brightness.spread_after_stops;
  if (!std::isfinite(before) || !std::isfinite(after)) return "";
  const char* meaning = "The gains hardly change this: the ground itself differs in brightness, or nothing does.";
  if (after < 0.8 * before) meaning = "The gains explain much of this; differences between bright and dark ground remain.";
  if (after > 1.1 * before && after > before + kAlikeStops) {
    meaning = "That is more than before: either the camera had evened out bright and dark ground, or the gains are wrong. Check the pictures below.";
  }
  return fmt::format("The mean light of the training photos varies by {} as recorded (standard deviation), and by {} with the gains taken out. {} ",
                     FormatFixed(before, 2, "stops"), FormatFixed(after, 2, "stops"), meaning);
}

std::string ViewCard(const BrightnessView& view) {
  std::string html = "<article class=\"card photo\"><header><h3>" + EscapeHtml(view.name) + "</h3>" +
                     Chips(Chip("exposure", SignedFixed(view.stops, 2, "stops"))) + "</header><div class=\"pics three\">";
  html += Picture("taken-pic", view.photo, view.width, view.height, "Photo as taken");
  html += Picture("recorded-pic", view.recorded, view.width, view.height, "Scene at the exposure of this photo");
  html += Picture("normal-pic", view.normal, view.width, view.height, "Scene at normal exposure");
  return html + "</div></article>\n";
}

constexpr size_t kShadingPictures = 36;
constexpr double kFullStops = 1.0;  // of shading, in full colour

std::string ShadingColor(double stops) {
  const double part = std::clamp(std::abs(stops) / kFullStops, 0.0, 1.0);
  const std::array<double, 3> full = stops < 0.0 ? std::array<double, 3>{24.0, 60.0, 130.0} : std::array<double, 3>{250.0, 160.0, 20.0};
  const auto mixed = [&](size_t c) { return static_cast<int>(std::lround(235.0 + part * (full[c] - 235.0))); };
  return fmt::format("rgb({},{},{})", mixed(0), mixed(1), mixed(2));
}

// A small picture of what was learned of one photo: as many squares as knots.
std::string ShadingPicture(const BrightnessPhoto& photo, const brightness::ShadingGrid& grid) {
  const auto [low, high] = std::minmax_element(photo.shading_stops.begin(), photo.shading_stops.end());
  std::string html =
      fmt::format("<svg width=\"104\" viewBox=\"0 0 {} {}\" role=\"img\"><title>{}: {} to {}</title>", grid.columns, grid.rows,
                  EscapeHtml(photo.name), SignedFixed(static_cast<double>(*low), 2), SignedFixed(static_cast<double>(*high), 2, "stops"));
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const auto stops = static_cast<double>(photo.shading_stops[static_cast<size_t>(row * grid.columns + column)]);
      html += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"1.02\" height=\"1.02\" fill=\"{}\"/>", column, row, ShadingColor(stops));
    }
  }
  return html + "</svg>\n";
}

// The photos with most shading, in order of capture.
std::string ShadingPictures(const BrightnessReport& brightness) {
  if (!brightness.shading_grid.On()) return "";
  std::vector<std::pair<float, size_t>> strongest;
  for (size_t i = 0; i < brightness.photos.size(); ++i) {
    const std::vector<float>& stops = brightness.photos[i].shading_stops;
    if (stops.empty()) continue;
    const auto [low, high] = std::minmax_element(stops.begin(), stops.end());
    strongest.emplace_back(*low - *high, i);
  }
  std::sort(strongest.begin(), strongest.end());
  strongest.resize(std::min(strongest.size(), kShadingPictures));
  std::sort(strongest.begin(), strongest.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::string html =
      "<h3>Light within the photos</h3><p>Training also learned how light differs within each photo, as where a cloud throws its shadow. " +
      fmt::format(
          "The {} photos with the largest differences, in the order in which they were taken: blue is darker than the photo's "
          "mean, orange brighter, full colour a stop or more. The scene and all that is made from it are without them.</p>",
          strongest.size()) +
      "<div class=\"shadings\" style=\"display:flex;flex-wrap:wrap;gap:6px\">";
  for (const auto& [range, photo] : strongest) html += ShadingPicture(brightness.photos[photo], brightness.shading_grid);
  return html + "</div>";
}

}  // namespace

std::string BrightnessSection(const ReportInput& input) {
  if (input.brightness == nullptr || input.brightness->Empty()) return "";
  const BrightnessReport& brightness = *input.brightness;
  const auto [low, high] = std::minmax_element(brightness.photos.begin(), brightness.photos.end(),
                                               [](const auto& a, const auto& b) { return a.exif_stops < b.exif_stops; });
  std::string chips =
      Chip("variation between photos",
           FormatFixed(brightness.spread_before_stops, 2) + " \xE2\x86\x92 " + FormatFixed(brightness.spread_after_stops, 2, "stops"), "main");
  if (Learned(brightness) && high->exif_stops - low->exif_stops >= kAlikeStops) {
    chips += Chip("trust in the tags", FormatPercent(brightness.trust_in_tags, 0));
  }
  const std::string lead =
      TagSentences(brightness, low->exif_stops, high->exif_stops) + SpreadSentences(brightness) + EscapeHtml(brightness.luminance);
  std::string html = SectionBegin("brightness", "Brightness", Chips(chips)) + Lead(lead) + "<div class=\"chart-grid\">" + GainChart(brightness) +
                     HistogramChart(brightness, brightness.vignetting.empty());
  if (!brightness.vignetting.empty()) html += VignettingChart(brightness);
  html += "</div>" + ShadingPictures(brightness);
  if (!brightness.views.empty()) {
    html += "<div class=\"views\">";
    for (const BrightnessView& view : brightness.views) html += ViewCard(view);
    html += "</div>";
  }
  return html + "</section>\n";
}

}  // namespace skyquilt::evaluate::page
