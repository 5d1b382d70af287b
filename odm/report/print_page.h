// Prints a page as PDF with a browser, where one is installed.
#pragma once

#include <filesystem>

namespace skyquilt::odm {

// Chromium or Chrome on the PATH; empty: none.
std::filesystem::path FindBrowser();
// False, with a warning, when the browser made no file. log: its messages. Throws base::Interrupted, and base::InputError when nothing can be
// written.
bool PrintPage(const std::filesystem::path& browser, const std::filesystem::path& html, const std::filesystem::path& pdf,
               const std::filesystem::path& log);

}  // namespace skyquilt::odm
