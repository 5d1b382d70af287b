// What a run gives up when its time is short, in the order in which it gives way. docs/commands.md has the same order.
#pragma once

#include <string>
#include <vector>

#include "coordinator/planning/work_size.h"
#include "coordinator/project/settings.h"
#include "core/config/override.h"

namespace skyquilt::coordinator {

struct Reduction {
  std::string what;   // "video": a later one of the same name goes further and takes its place
  std::string stage;  // whose options it changes, the first of them: decided when that stage begins
  std::string text;   // for people: "a video of 2 s instead of 5 s"
  std::vector<config::Override> changes;
};

// Those that change something in these settings: each makes less than the settings, and than those before it in the list.
std::vector<Reduction> ReductionsOf(const Settings& settings, const WorkSize& size);

// Changes the settings. Throws base::UsageError as Settings::Set does.
void Apply(const Reduction& reduction, Settings* settings);

// Texts of reductions that are in force: of those with the same name the last.
std::vector<std::string> TextsOf(const std::vector<Reduction>& reductions);

}  // namespace skyquilt::coordinator
