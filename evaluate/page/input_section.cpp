#include <fmt/core.h>

#include "core/base/text.h"
#include "evaluate/page/page_parts.h"
#include "evaluate/page/report_page.h"

namespace skyquilt::evaluate::page {

namespace {

std::string Counted(int64_t n, const char* one, const char* several) {
  return FormatInteger(n) + " " + (n == 1 ? one : several);
}

std::string GroupRow(const InputGroup& group) {
  const std::string reason = group.several ? "each its own, such as: " + group.reason : group.reason;
  const bool more = group.n > static_cast<int64_t>(group.examples.size());
  return "<tr>" + TextCell(group.kind) + TextCell(group.taken ? "yes" : "no") + NumberCell(static_cast<double>(group.n), FormatInteger(group.n)) +
         TextCell(reason) + TextCell(base::Join(group.examples) + (more ? ", ..." : "")) + "</tr>";
}

}  // namespace

std::string InputSection(const ReportInput& input) {
  const InputFiles& files = input.files;
  if (!files.Remarkable()) return "";
  std::string html = "<section id=\"input\"><div class=\"heading\"><h2>Photo folder</h2></div><p class=\"lead\">" +
                     Counted(files.n_taken, "photo was", "photos were") + " taken, ";
  html += files.n_left_out > 0 ? Counted(files.n_left_out, "other file or folder was", "other files and folders were") + " left out."
                               : std::string("and nothing was left out.");
  html +=
      " Every file is in survey/input.csv; prepare.photos chooses others.</p><div class=\"card scroll\"><table class=\"sortable\"><thead><tr>"
      "<th>Kind</th><th>Taken as photos</th><th class=\"num\">Files</th><th>Reason</th><th>Such as</th></tr></thead><tbody>";
  for (const InputGroup& group : files.groups) html += GroupRow(group);
  return html + "</tbody></table></div></section>\n";
}

}  // namespace skyquilt::evaluate::page
