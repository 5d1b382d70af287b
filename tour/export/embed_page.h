// embed.html: how to show a tour in another page.
#pragma once

#include <string>

namespace skyquilt::tour {

// A page without scripts: the snippet as text to copy, and the same at work. title: of the tour; may contain anything.
std::string EmbedPage(const std::string& title);

}  // namespace skyquilt::tour
