// Files of finished pictures of depth: one each while they are being rendered, in the end one for all.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "surface/views/depth_filter.h"

namespace skyquilt::surface {

// `key` has 16 characters and stands for everything but the pose that the pictures depend on.

// "view_00042.bin"
std::string ViewFileName(size_t view);
// Atomic, with a checksum. Throws base::InputError.
void SaveView(const RenderedView& view, const std::string& key, const std::filesystem::path& file);
// Nothing when there is no such file, when it is damaged, and when it was made for another pose or key.
std::optional<RenderedView> LoadView(const std::filesystem::path& file, const ViewPose& pose, const std::string& key);

// The same, but throws base::InputError instead.
RenderedView RequireView(const std::filesystem::path& file, const ViewPose& pose, const std::string& key);

// Joins the files of these poses, in their order, one after the other in memory; atomic. Throws base::InputError when one is missing or
// damaged or the disk is full, base::Interrupted.
void JoinViews(const std::vector<ViewPose>& poses, const std::string& key, const std::vector<std::filesystem::path>& parts,
               const std::filesystem::path& file);

}  // namespace skyquilt::surface
