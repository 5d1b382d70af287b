// Layout of scene.h5, shared by the merge stage that writes it and Scene that reads it.
#pragma once

#include <cstdint>
#include <string>

namespace skyquilt::render {

constexpr const char* kSceneKind = "scene";
constexpr int kSceneVersion = 1;
constexpr const char* kContextPrefix = "context/";
inline std::string BlockPrefix(int64_t i) {
  return "blocks/" + std::to_string(i) + "/";
}

}  // namespace skyquilt::render
