#include "odm/report/print_page.h"

#include <unistd.h>

#include "core/base/child_process.h"
#include "core/base/log.h"
#include "core/base/output_file.h"

namespace skyquilt::odm {
namespace {

// Text of a file's address: everything but plain letters, digits and "/-_.~" in hexadecimal.
std::string FileAddress(const std::filesystem::path& file) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string address = "file://";
  for (const char c : std::filesystem::absolute(file).string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || std::string("/-_.~").find(c) != std::string::npos;
    if (plain) {
      address += c;
    } else {
      address += '%';
      address += kDigits[byte >> 4];
      address += kDigits[byte & 15];
    }
  }
  return address;
}

}  // namespace

std::filesystem::path FindBrowser() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable"}) {
    std::filesystem::path program = base::FindProgram(name);
    if (!program.empty()) return program;
  }
  return {};
}

bool PrintPage(const std::filesystem::path& browser, const std::filesystem::path& html, const std::filesystem::path& pdf,
               const std::filesystem::path& log) {
  base::PartialPath made(pdf);
  // A service may have no home to write to.
  const base::PartialPath profile(pdf.parent_path() / "browser");
  base::Command command{.program = browser,
                        .arguments = {"--headless", "--disable-gpu", "--no-first-run", "--disable-extensions", "--disable-dev-shm-usage",
                                      "--virtual-time-budget=20000", "--no-pdf-header-footer", "--print-to-pdf-no-header",
                                      "--user-data-dir=" + profile.path().string(), "--print-to-pdf=" + made.path().string()}};
  if (geteuid() == 0) command.arguments.emplace_back("--no-sandbox");  // Chromium refuses to run as root otherwise
  command.arguments.push_back(FileAddress(html));
  const int status = base::RunLogged(command, log, {});
  std::error_code ignored;
  if (status != 0 || !std::filesystem::exists(made.path(), ignored) || std::filesystem::file_size(made.path(), ignored) == 0) {
    base::LogWarning("{} could not print the report (status {}, see {}); {} has it as a page", browser.filename().string(), status, log.string(),
                     html.string());
    return false;
  }
  made.Publish();
  return true;
}

}  // namespace skyquilt::odm
