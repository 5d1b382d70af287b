#include "core/gis/photo_bands.h"

#include <cmath>
#include <cstdint>

#include "core/gis/gdal_support.h"

namespace skyquilt::gis {
namespace {

constexpr const char* kPhotoFix = "Copy it again from the memory card, or remove it from the folder";

[[noreturn]] void FailReadingPhoto(const std::filesystem::path& file) {
  const std::string reason = CPLGetLastErrorMsg();
  throw base::InputError(file, "cannot be decoded" + (reason.empty() ? "" : " (" + reason + ")"), kPhotoFix);
}

}  // namespace

struct PhotoBands::Impl {
  internal::Dataset dataset;
};

PhotoBands::PhotoBands(const std::filesystem::path& file) : file_(file), impl_(std::make_unique<Impl>()) {
  const internal::QuietErrors quiet;
  GDALRegister_GTiff();
  GDALRegister_PNG();
  // Nothing beside the photo is read: an overview or a table of another program says nothing of its pixels.
  const char* const drivers[] = {"GTiff", "PNG", nullptr};
  const char* const no_siblings[] = {nullptr};
  impl_->dataset.reset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, nullptr, no_siblings));
  if (!impl_->dataset || impl_->dataset->GetRasterCount() < 1) FailReadingPhoto(file);
  width_ = impl_->dataset->GetRasterXSize();
  height_ = impl_->dataset->GetRasterYSize();
  bands_ = impl_->dataset->GetRasterCount();
  constexpr int64_t kMostPixels = int64_t{1} << 30;
  if (int64_t{width_} * height_ > kMostPixels) {
    throw base::InputError(file, "says that it has " + std::to_string(width_) + "x" + std::to_string(height_) + " pixels", kPhotoFix);
  }
}

bool PhotoBands::IsRgb() const {
  return bands_ >= 3 && impl_->dataset->GetRasterBand(1)->GetColorInterpretation() == GCI_RedBand &&
         impl_->dataset->GetRasterBand(2)->GetColorInterpretation() == GCI_GreenBand &&
         impl_->dataset->GetRasterBand(3)->GetColorInterpretation() == GCI_BlueBand;
}

PhotoBands::~PhotoBands() {
  const internal::QuietErrors quiet;
  impl_.reset();
}

std::vector<std::string> PhotoBands::Names() const {
  std::vector<std::string> names;
  for (int band = 1; band <= bands_; ++band) names.emplace_back(impl_->dataset->GetRasterBand(band)->GetDescription());
  return names;
}

void PhotoBands::ReadRows(int first_row, int n_rows, std::span<const int> bands, std::span<float> values) const {
  const internal::QuietErrors quiet;
  const size_t n = static_cast<size_t>(n_rows) * static_cast<size_t>(width_) * bands.size();
  SKYQUILT_CHECK(values.size() == n, std::to_string(values.size()) + " values instead of " + std::to_string(n));
  std::vector<int> list(bands.begin(), bands.end());
  const GSpacing pixel = static_cast<GSpacing>(sizeof(float)) * static_cast<GSpacing>(bands.size());
  if (impl_->dataset->RasterIO(GF_Read, 0, first_row, width_, n_rows, values.data(), width_, n_rows, GDT_Float32, static_cast<int>(list.size()),
                               list.data(), pixel, pixel * width_, sizeof(float), nullptr) != CE_None) {
    FailReadingPhoto(file_);
  }
  for (size_t b = 0; b < bands.size(); ++b) {
    int has_nodata = FALSE;
    const double nodata = impl_->dataset->GetRasterBand(bands[b])->GetNoDataValue(&has_nodata);
    for (size_t i = b; i < n; i += bands.size()) {
      if (std::isnan(values[i]) || (has_nodata && values[i] == static_cast<float>(nodata))) values[i] = 0.0F;
    }
  }
}

}  // namespace skyquilt::gis
