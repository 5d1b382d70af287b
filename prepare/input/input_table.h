// What the user is told of the files in the photo folder: a table, a line in the log, and warnings where photos may have been meant.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "prepare/input/list_files.h"

namespace skyquilt::prepare::input {

// CSV: file, taken (yes or no), kind, reason, shot, mask, width, height; empty where not known. Throws base::InputError.
void WriteInputTable(const std::vector<InputFile>& files, const std::filesystem::path& file);

// "84 single bands, 12 thumbnails": what is left out, less files that nobody takes for photos. Empty: nothing.
std::string LeftOutText(const std::vector<InputFile>& files);

// One line for the log: how many photos are taken, how many files of which kinds are not. `table`: where it is written.
std::string SummaryText(const std::vector<InputFile>& files, const std::filesystem::path& table);

// Warnings: pictures that could be photos after a conversion, one band for all, and other projects, each with what to do.
std::vector<std::string> InputWarnings(const std::filesystem::path& root, const std::vector<InputFile>& files);

}  // namespace skyquilt::prepare::input
