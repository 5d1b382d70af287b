#include "evaluate/page/written_pictures.h"

#include <algorithm>
#include <array>
#include <string>
#include <system_error>

namespace skyquilt::evaluate::page {

namespace {

// Calls visit with every member. The lists must be complete: this does not compile otherwise.
template <typename Images, typename Visit>
void VisitImages(Images& images, Visit visit) {
  auto& [photo, render, error, depth, normals, true_normals, trust, mesh, width, height, depth_low_m, depth_high_m] = images;
  visit(photo, render, error, depth, normals, true_normals, trust, mesh, width, height, depth_low_m, depth_high_m);
}

template <typename View, typename Visit>
void VisitView(View& view, Visit visit) {
  auto& [name, stops, photo, recorded, normal, width, height] = view;
  visit(name, stops, photo, recorded, normal, width, height);
}

constexpr size_t kFewestBytes = 8;  // of an element of either list: the length of one of its texts

}  // namespace

void WrittenPictures::Save(base::BytePacker* out) const {
  const auto add = [out](const auto&... member) { (out->Add(member), ...); };
  out->AddCount(images.size());
  for (const PhotoImages& one : images) VisitImages(one, add);
  out->AddCount(views.size());
  for (const BrightnessView& one : views) VisitView(one, add);
  out->Add(n_with_normals);
}

void WrittenPictures::Load(base::ByteUnpacker* in) {
  const auto take = [in](auto&... member) { (in->Take(&member), ...); };
  images.resize(in->TakeCount(kFewestBytes));
  for (PhotoImages& one : images) VisitImages(one, take);
  if (in->TakeCount(kFewestBytes) != views.size()) in->Fail();
  for (BrightnessView& one : views) VisitView(one, take);
  in->Take(&n_with_normals);
}

bool WrittenPictures::Exist(const std::filesystem::path& report_folder) const {
  const auto is_there = [&](const std::string& file) {
    std::error_code ignored;
    return file.empty() || std::filesystem::is_regular_file(report_folder / file, ignored);
  };
  const auto all = [&](const auto& files) { return std::ranges::all_of(files, is_there); };
  return std::ranges::all_of(images, [&](const PhotoImages& one) { return all(one.Files()); }) &&
         std::ranges::all_of(views, [&](const BrightnessView& one) {
           return all(std::array{one.photo, one.recorded, one.normal});
         });
}

}  // namespace skyquilt::evaluate::page
