// Tables of photo positions: OpenDroneMap's geo.txt and DJI's .MRK.
#include "prepare/photo_positions.h"
#include "tests/fuzz/fuzz_target.h"

namespace skyquilt::fuzz {

std::vector<std::string> Seeds() {
  return {"EPSG:4326\nDJI_0028.JPG -91.99 46.84 198.6 0 0 0 0.02 0.04 label\nDJI_0032.JPG\t-91.98\t46.85\n",
          "WGS84 UTM 32N\na.jpg 450000 5200000 100\n",
          "+proj=utm +zone=10 +ellps=WGS84 +datum=WGS84 +units=m +no_defs\n# comment\na.jpg 500000 4600000\n",
          "1\t434205.122132\t[2036]\t   -10,N\t    18,E\t   193,V\t22.54000000,Lat\t113.90000000,Lon\t100.100,Ellh\t0.0118, 0.0107, 0.0249\t50,Q\n"};
}

void Feed(const std::string& bytes) {
  FeedFile("geo.txt", bytes, [](const std::filesystem::path& file) { prepare::ReadGeoFile(file); });
  FeedFile("a.MRK", bytes, [](const std::filesystem::path& file) { prepare::ReadMrkFile(file); });
}

}  // namespace skyquilt::fuzz
