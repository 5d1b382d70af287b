#include "core/image/draw_text.h"

#include <opencv2/imgproc.hpp>

#include "core/base/errors.h"

namespace skyquilt::image {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kCapital_px = 21.0;  // height of this font's capital letters at scale 1

}  // namespace

void DrawText(Image8* image, const std::string& text, int x, int y, double height_px) {
  SKYQUILT_CHECK(image->channels == 3, "text is drawn into RGB images");
  cv::Mat pixels(image->height, image->width, CV_8UC3, image->data.data());
  cv::putText(pixels, text, {x, y}, kFont, height_px / kCapital_px, {0, 0, 0}, 1, cv::LINE_AA);
}

int TextWidth(const std::string& text, double height_px) {
  int below = 0;
  return cv::getTextSize(text, kFont, height_px / kCapital_px, 1, &below).width;
}

}  // namespace skyquilt::image
