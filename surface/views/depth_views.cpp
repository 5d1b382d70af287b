#include "surface/views/depth_views.h"

#include "core/base/errors.h"
#include "core/base/file.h"
#include "surface/views/view_record.h"

namespace skyquilt::surface {

DepthViews DepthViews::Open(const std::filesystem::path& file) {
  DepthViews views;
  views.map_ = base::MemoryMap(file);
  const std::span<const uint8_t> bytes = views.map_.bytes();
  const auto fail = [&file](const std::string& found) { throw base::InputError(file, found, "Remove the file and run the command again"); };

  ViewsHeader header;
  if (bytes.size() < sizeof(header)) fail("is too short for a file of surface views");
  const ViewsHeader expected;
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.magic != expected.magic) fail("is not a file of surface views of this version");
  if (header.views > (bytes.size() - sizeof(header)) / sizeof(ViewRecord)) fail("is cut off in its list of views");
  const auto n_views = static_cast<size_t>(header.views);
  const std::string_view records(reinterpret_cast<const char*>(bytes.data()) + sizeof(header), n_views * sizeof(ViewRecord));
  if (base::HashHex(records) != std::string_view(header.checksum.data(), header.checksum.size())) fail("has a damaged list of views");

  size_t offset = sizeof(header) + records.size();
  for (size_t i = 0; i < n_views; ++i) {
    ViewRecord record;
    std::memcpy(&record, records.data() + i * sizeof(record), sizeof(record));
    const std::optional<ViewPose> pose = PoseOf(record);
    if (!pose) fail("has an impossible camera for view " + std::to_string(i));
    const size_t picture = PictureBytes(*pose);
    if (picture + kPictureHashBytes > bytes.size() - offset) fail("is cut off in view " + std::to_string(i));
    const auto text = [&](size_t from, size_t size) { return std::string_view(reinterpret_cast<const char*>(bytes.data()) + from, size); };
    if (base::HashHex(text(offset, picture)) != text(offset + picture, kPictureHashBytes)) fail("is damaged in view " + std::to_string(i));
    views.poses_.push_back(*pose);
    views.offset_.push_back(offset);
    offset += picture + kPictureHashBytes;
  }
  if (offset != bytes.size()) fail("has " + std::to_string(bytes.size() - offset) + " bytes too many");
  views.key_.assign(header.key.data(), header.key.size());
  views.ReleasePages();  // all were read for their checksums
  return views;
}

DepthView DepthViews::operator[](size_t view) const {
  const size_t n_pixels = PixelsOf(poses_[view]);
  // The map begins at a page and all offsets are multiples of 8.
  const uint8_t* picture = map_.bytes().data() + offset_[view];
  const uint8_t* cosine = picture + n_pixels * sizeof(float);
  return {poses_[view], {reinterpret_cast<const float*>(picture), n_pixels}, {cosine, n_pixels}, {cosine + n_pixels, n_pixels}};
}

std::vector<DepthView> DepthViews::All() const {
  std::vector<DepthView> all;
  all.reserve(size());
  for (size_t view = 0; view < size(); ++view) all.push_back((*this)[view]);
  return all;
}

}  // namespace skyquilt::surface
