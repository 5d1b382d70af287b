// Tables of photo positions: OpenDroneMap's geo.txt, others like it, and DJI's .MRK.
#include "prepare/georeference/tags/geo_table.h"
#include "prepare/georeference/tags/photo_positions.h"
#include "tests/fuzz/fuzz_target.h"

namespace skyquilt::fuzz {
namespace {

const std::vector<prepare::input::PhotoFile>& Photos() {
  static const std::vector<prepare::input::PhotoFile> photos = [] {
    std::vector<prepare::input::PhotoFile> all;
    for (const char* name : {"a.jpg", "flight/DJI_0028.JPG", "other/DJI_0028.JPG", "my photo 2.jpg"}) {
      prepare::input::PhotoFile photo{.name = name, .width = 4, .height = 3, .tags = {}};
      photo.tags.gps = geo::Geodetic{46.84, -91.99, 200.0};
      all.push_back(photo);
    }
    return all;
  }();
  return photos;
}

}  // namespace

std::vector<std::string> Seeds() {
  return {
      "EPSG:4326\nDJI_0028.JPG -91.99 46.84 198.6 0 0 0 0.02 0.04 label\nDJI_0032.JPG\t-91.98\t46.85\n",
      "WGS84 UTM 32N\na.jpg 450000 5200000 100\n",
      "+proj=utm +zone=10 +ellps=WGS84 +datum=WGS84 +units=m +no_defs\n# comment\na.jpg 500000 4600000\n",
      "\xEF\xBB\xBF\"EPSG:4326\",,,\r\nphoto,lat,lon,height\r\n\"my photo 2.jpg\",46.84,-91.99,NaN\r\nC:\\x\\flight\\DJI_0028.JPG,46.84,-91.99,3\r\n",
      "EPSG:4326\nmy photo 2;46,84;-91,99;3;0,02;0,05\na;0;0;0\n",
      "#Label\tX/Longitude\tY/Latitude\tZ/Altitude\na\t-91,99\t46,84\t198,5\n",
      "1\t434205.122132\t[2036]\t   -10,N\t    18,E\t   193,V\t22.54000000,Lat\t113.90000000,Lon\t100.100,Ellh\t0.0118, 0.0107, 0.0249\t50,Q\n"};
}

void Feed(const std::string& bytes) {
  FeedFile("geo.txt", bytes, [](const std::filesystem::path& file) { prepare::georeference::ReadGeoTable(file, Photos()); });
  FeedFile("a.MRK", bytes, [](const std::filesystem::path& file) { prepare::georeference::ReadMrkFile(file); });
}

}  // namespace skyquilt::fuzz
