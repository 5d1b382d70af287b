#include "viewer/protocol/replies.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "viewer/protocol/messages.h"

namespace skyquilt::viewer {
namespace {

// Keeps the order in which members are written.
using Reply = nlohmann::ordered_json;

constexpr size_t kLongestText = 2000;  // bytes of a message that is shown

// Not finite numbers become null; bytes that are not UTF-8 become U+FFFD.
std::string Dump(const Reply& reply) {
  return base::JsonText(reply);
}

std::string Shortened(std::string_view text) {
  if (text.size() <= kLongestText) return std::string(text);
  size_t end = kLongestText;
  // Not within a character of several bytes.
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return std::string(text.substr(0, end)) + " ...";
}

template <int kN>
Reply ListOf(const Eigen::Matrix<double, kN, 1>& x) {
  Reply list = Reply::array();
  for (int i = 0; i < kN; ++i) list.push_back(x[i]);
  return list;
}

Reply EngineObject(const EngineState& state) {
  return {{"ready", state.ready},       {"reason", Shortened(state.reason)}, {"revision", state.revision},
          {"exposure", state.exposure}, {"clients", state.clients},          {"ranks", state.ranks}};
}

}  // namespace

std::string WelcomeText(uint64_t client, const EngineState& state) {
  return Dump({{"type", "welcome"}, {"version", kProtocolVersion}, {"client", client}, {"engine", EngineObject(state)}});
}

std::string EngineText(const EngineState& state) {
  return Dump({{"type", "engine"}, {"engine", EngineObject(state)}});
}

std::string ErrorText(std::string_view message, std::optional<uint32_t> id) {
  Reply reply = {{"type", "error"}, {"message", Shortened(message)}};
  if (id) reply["id"] = *id;
  return Dump(reply);
}

std::string ProgressText(uint32_t id, double fraction) {
  return Dump({{"type", "progress"}, {"id", id}, {"fraction", std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0}});
}

std::string PickedText(uint32_t id, const SurfacePoint& point) {
  Reply reply = {{"type", "picked"}, {"id", id}, {"hit", point.hit}, {"point", nullptr}, {"depth_m", nullptr}, {"spread_m", nullptr}};
  if (point.hit) {
    reply["point"] = ListOf(point.point_enu);
    reply["depth_m"] = point.depth_m;
    reply["spread_m"] = point.spread_m;
  }
  reply["opacity"] = point.opacity;
  return Dump(reply);
}

std::string PhotosText(uint32_t id, bool checked, const std::vector<PhotoSight>& photos) {
  Reply list = Reply::array();
  for (const PhotoSight& sight : photos) {
    list.push_back({{"photo", sight.photo},
                    {"pixel", ListOf(sight.pixel)},
                    {"distance_m", sight.distance_m},
                    {"gsd_m", sight.gsd_m},
                    {"visible", sight.visible}});
  }
  return Dump({{"type", "photos"}, {"id", id}, {"checked", checked}, {"photos", std::move(list)}});
}

std::string ProfileText(uint32_t id, double length_m, const std::vector<double>& heights_m, const std::vector<double>& spreads_m) {
  return Dump({{"type", "profile"}, {"id", id}, {"length_m", length_m}, {"heights_m", Reply(heights_m)}, {"spreads_m", Reply(spreads_m)}});
}

std::string VolumeText(uint32_t id, const VolumeResult& result) {
  return Dump({{"type", "volume"},
               {"id", id},
               {"cell_m", result.cell_m},
               {"cells", result.cells},
               {"filled", result.filled},
               {"plan_area_m2", result.plan_area_m2},
               {"surface_area_m2", result.surface_area_m2},
               {"cut_m3", result.cut_m3},
               {"fill_m3", result.fill_m3},
               {"net_m3", result.net_m3},
               {"sigma_m3", result.sigma_m3},
               {"base_mean_m", result.base_mean_m}});
}

std::string TrustMapText(uint32_t id, const TrustMapResult& result) {
  return Dump({{"type", "trust_map"},
               {"id", id},
               {"url", result.url},
               {"min", ListOf(result.min_enu)},
               {"max", ListOf(result.max_enu)},
               {"scale", result.scale}});
}

std::string ErrorMapText(uint32_t id, const ErrorMapResult& result) {
  return Dump({{"type", "error_map"},
               {"id", id},
               {"url", result.url},
               {"min", ListOf(result.min_enu)},
               {"max", ListOf(result.max_enu)},
               {"scale", result.scale},
               {"photos", result.photos},
               {"of_photos", result.of_photos}});
}

}  // namespace skyquilt::viewer
