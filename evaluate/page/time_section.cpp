#include <fmt/core.h>

#include <cmath>

#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"

namespace skyquilt::evaluate::page {

std::string TimeSection(const metrics::Metrics& metrics) {
  if (!metrics.times) return "";
  const metrics::RunTimes& times = *metrics.times;
  std::string html = SectionBegin("time", "Time") + Lead(fmt::format("{} were allowed for all stages, {} were used up to this report.",
                                                                     ShownDuration(times.within_s), ShownDuration(times.used_s)));
  html += TableBegin(Headings({"Stage"}) + NumberHeadings({"Planned at first", "Predicted when it began", "Taken", "Error of the prediction"}));
  const auto seconds = [](double value) { return NumberCell(value, ShownDuration(value)); };
  for (const metrics::StageTimes& stage : times.stages) {
    const double error = stage.took_s > 0.0 ? stage.predicted_s / stage.took_s - 1.0 : kNotMeasured;
    html += "<tr><td>" + EscapeHtml(stage.stage) + "</td>" + seconds(stage.planned_s) + seconds(stage.predicted_s) + seconds(stage.took_s) +
            NumberCell(error, std::isfinite(error) ? fmt::format("{:+.0f} %", 100.0 * error) : FormatPercent(kNotMeasured)) + "</tr>";
  }
  html += kTableEnd;
  if (times.given_up.empty()) return html + Note("Nothing was given up for it.") + "</section>\n";
  html += "<div class=\"card prose\"><h3>Given up for it</h3><ul>";
  for (const std::string& one : times.given_up) html += "<li>" + EscapeHtml(one) + "</li>";
  return html + "</ul></div></section>\n";
}

}  // namespace skyquilt::evaluate::page
