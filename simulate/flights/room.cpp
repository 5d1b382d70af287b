#include "simulate/flights/room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kRoomYaw_rad = 20.0F * std::numbers::pi_v<float> / 180.0F;  // counter-clockwise
constexpr float kHalfRoomX = 3.0F, kHalfRoomY = 2.5F, kCeiling = 2.6F;      // inside, metres
constexpr float kThick = 0.4F;                                              // of walls, floor and ceiling: lets no light through (AmbientVolume)
constexpr float kHalfWindow = 0.9F, kSill = 0.9F, kHead = 2.2F;             // in the middle of the wall at -y, towards the sun

// Objects of Part::kRoomWall.
enum RoomWall : uint32_t { kWallLeft, kWallRight, kWallWindow, kWallDoor, kWallCeiling, kWallOutside };
constexpr std::array<std::array<float, 3>, 6> kWallColors = {
    {{0.66F, 0.62F, 0.52F}, {0.66F, 0.62F, 0.52F}, {0.70F, 0.69F, 0.66F}, {0.42F, 0.52F, 0.55F}, {0.78F, 0.78F, 0.77F}, {0.60F, 0.56F, 0.48F}}};

enum class Finish { kPaint, kWood, kCloth, kPainting };
struct Piece {
  Vector3f bottom;  // its middle
  Vector2f half;
  float height;
  Vector3f color;
  Finish finish;
};

const std::array<Piece, 13>& Pieces() {
  static const std::array<Piece, 13> pieces = {{
      {{-2.62F, 1.85F, 0.0F}, {0.36F, 0.55F}, 2.0F, {0.20F, 0.12F, 0.07F}, Finish::kWood},           // cupboard
      {{0.55F, 2.05F, 0.0F}, {1.0F, 0.42F}, 0.42F, {0.16F, 0.22F, 0.34F}, Finish::kCloth},           // sofa
      {{0.55F, 2.39F, 0.0F}, {1.0F, 0.09F}, 0.85F, {0.16F, 0.22F, 0.34F}, Finish::kCloth},           // its back
      {{2.45F, -0.5F, 0.0F}, {0.5F, 0.8F}, 0.74F, {0.42F, 0.30F, 0.18F}, Finish::kWood},             // chest
      {{2.5F, -0.9F, 0.74F}, {0.14F, 0.14F}, 0.32F, {0.55F, 0.12F, 0.08F}, Finish::kPaint},          // a box on it
      {{-2.78F, -1.0F, 0.0F}, {0.2F, 0.7F}, 0.9F, {0.62F, 0.61F, 0.58F}, Finish::kPaint},            // shelf
      {{-2.78F, -1.35F, 0.9F}, {0.12F, 0.10F}, 0.24F, {0.10F, 0.28F, 0.14F}, Finish::kPaint},        // books
      {{-2.78F, -0.9F, 0.9F}, {0.12F, 0.16F}, 0.19F, {0.45F, 0.30F, 0.05F}, Finish::kPaint},         // more of them
      {{0.0F, 0.0F, 0.0F}, {0.9F, 0.6F}, 0.012F, {0.38F, 0.10F, 0.09F}, Finish::kCloth},             // rug
      {{-1.3F, 2.48F, 0.0F}, {0.45F, 0.02F}, 2.05F, {0.50F, 0.38F, 0.24F}, Finish::kWood},           // door
      {{2.985F, 0.9F, 1.15F}, {0.015F, 0.45F}, 0.65F, {0.30F, 0.34F, 0.28F}, Finish::kPainting},     // picture
      {{-2.985F, 0.3F, 1.3F}, {0.015F, 0.3F}, 0.45F, {0.40F, 0.30F, 0.22F}, Finish::kPainting},      // picture
      {{0.0F, -2.7F, kSill}, {0.03F, 0.03F}, kHead - kSill, {0.70F, 0.70F, 0.68F}, Finish::kPaint},  // mullion
  }};
  return pieces;
}

// Points of the room in ENU and back.
Vector3f EnuFromRoom(const Vector3f& p) {
  const float c = std::cos(kRoomYaw_rad), s = std::sin(kRoomYaw_rad);
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z()};
}

Vector3f RoomFromEnu(const Vector3f& p) {
  const float c = std::cos(kRoomYaw_rad), s = std::sin(kRoomYaw_rad);
  return {c * p.x() + s * p.y(), c * p.y() - s * p.x(), p.z()};
}

// An upright rectangle over the line from one place to another; it faces to the right of that way.
void AddPanel(const Vector2f& from, const Vector2f& to, float bottom, float top, Tag tag, Mesh& mesh) {
  const auto corner = [](const Vector2f& at, float z) { return EnuFromRoom({at.x(), at.y(), z}); };
  mesh.AddQuad(corner(from, bottom), corner(to, bottom), corner(to, top), corner(from, top), tag);
}

// A level rectangle from `low` to `high` that faces up or down.
void AddSlab(const Vector2f& low, const Vector2f& high, float z, bool up, Tag tag, Mesh& mesh) {
  const Vector3f a = EnuFromRoom({low.x(), low.y(), z}), c = EnuFromRoom({high.x(), high.y(), z});
  const Vector3f right = EnuFromRoom({high.x(), low.y(), z}), left = EnuFromRoom({low.x(), high.y(), z});
  mesh.AddQuad(a, up ? right : left, c, up ? left : right, tag);
}

// The wall at -y around the window, from -x to x when seen from outside.
void AddWindowWall(float half, float y, float bottom, float top, bool inwards, Tag tag, Mesh& mesh) {
  const auto panel = [&](float from, float to, float low, float high) {
    AddPanel({inwards ? to : from, y}, {inwards ? from : to, y}, low, high, tag, mesh);
  };
  panel(-half, -kHalfWindow, bottom, top);
  panel(-kHalfWindow, kHalfWindow, bottom, kSill);
  panel(-kHalfWindow, kHalfWindow, kHead, top);
  panel(kHalfWindow, half, bottom, top);
}

void AddShell(Mesh& mesh) {
  const auto wall = [](RoomWall which) { return Tag{Part::kRoomWall, which}; };
  const float x = kHalfRoomX, y = kHalfRoomY;
  AddSlab({-x, -y}, {x, y}, 0.0F, true, {Part::kRoomFloor, 0}, mesh);
  AddSlab({-x, -y}, {x, y}, kCeiling, false, wall(kWallCeiling), mesh);
  AddPanel({-x, -y}, {-x, y}, 0.0F, kCeiling, wall(kWallLeft), mesh);
  AddPanel({x, y}, {x, -y}, 0.0F, kCeiling, wall(kWallRight), mesh);
  AddPanel({-x, y}, {x, y}, 0.0F, kCeiling, wall(kWallDoor), mesh);
  AddWindowWall(x, -y, 0.0F, kCeiling, true, wall(kWallWindow), mesh);
  // The hole.
  const float w = kHalfWindow, out = -y - kThick;
  AddPanel({-w, out}, {-w, -y}, kSill, kHead, wall(kWallWindow), mesh);
  AddPanel({w, -y}, {w, out}, kSill, kHead, wall(kWallWindow), mesh);
  AddSlab({-w, out}, {w, -y}, kSill, true, wall(kWallWindow), mesh);
  AddSlab({-w, out}, {w, -y}, kHead, false, wall(kWallWindow), mesh);
  // Outside.
  const float ox = x + kThick, oy = y + kThick, top = kCeiling + kThick;
  const auto ground = static_cast<float>(kGroundAtRoom_m);
  AddSlab({-ox, -oy}, {ox, oy}, top, true, wall(kWallOutside), mesh);
  AddPanel({ox, -oy}, {ox, oy}, ground, top, wall(kWallOutside), mesh);
  AddPanel({ox, oy}, {-ox, oy}, ground, top, wall(kWallOutside), mesh);
  AddPanel({-ox, oy}, {-ox, -oy}, ground, top, wall(kWallOutside), mesh);
  AddWindowWall(ox, -oy, ground, top, false, wall(kWallOutside), mesh);
}

Vector3f FloorColor(const Vector3f& at, float footprint) {
  constexpr float kBoard = 0.14F;
  const int board = FloorInt(at.y() / kBoard);
  const float grain = FractalNoise(0.15F * at.x(), at.y(), {0.08F, 3, 0.6F}, 31U + static_cast<uint32_t>(board + 64), footprint);
  const float seam = PulseTrain(at.y() / kBoard, 0.05F, footprint / kBoard);
  return Vector3f(0.36F, 0.24F, 0.14F) * (0.85F + 0.3F * HashUnit(board, 3, 77U) + 0.2F * grain) * (1.0F - 0.6F * seam);
}

Vector3f PieceColor(const Piece& piece, const Vector3f& at, uint32_t seed, float footprint) {
  // Height in both, so that upright faces have a pattern too.
  const float u = at.x() + 0.6F * at.z(), v = at.y() - 0.8F * at.z();
  switch (piece.finish) {
    case Finish::kPaint:
      return piece.color;
    case Finish::kWood:
      return piece.color * (1.0F + 0.3F * FractalNoise(u + v, 0.2F * (v - u), {0.12F, 3, 0.6F}, seed, footprint));
    case Finish::kCloth: {
      const float stripes = PulseTrain(u / 0.16F, 0.35F, footprint / 0.16F) + PulseTrain(v / 0.16F, 0.35F, footprint / 0.16F);
      return piece.color + 0.12F * stripes * Vector3f(0.9F, 0.8F, 0.6F);
    }
    case Finish::kPainting: {
      const float red = FractalNoise(u, v, {0.3F, 4, 0.6F}, seed, footprint), blue = FractalNoise(v, u, {0.2F, 4, 0.6F}, seed + 9U, footprint);
      return piece.color.cwiseProduct(Vector3f(1.0F + 0.6F * red, 1.0F + 0.3F * (red + blue), 1.0F + 0.6F * blue));
    }
  }
  return piece.color;
}

}  // namespace

void AddRoom(Mesh& mesh) {
  AddShell(mesh);
  for (size_t i = 0; i < Pieces().size(); ++i) {
    const Piece& piece = Pieces()[i];
    const Tag tag{Part::kRoomFurniture, static_cast<uint32_t>(i)};
    mesh.AddBox(EnuFromRoom(piece.bottom), {piece.half.x(), piece.half.y(), 0.0F}, piece.height, kRoomYaw_rad, tag, tag);
  }
}

Surface RoomSurface(const Hit& hit) {
  const Vector3f at = RoomFromEnu(hit.position);
  const float footprint = SurfaceFootprint(hit);
  Surface surface;
  surface.normal = hit.normal;
  if (hit.tag.part == Part::kRoomFloor) {
    surface.albedo = FloorColor(at, footprint);
  } else if (hit.tag.part == Part::kRoomFurniture) {
    surface.albedo = PieceColor(Pieces()[hit.tag.object], at, 200U + 16U * hit.tag.object, footprint);
  } else {
    const std::array<float, 3>& color = kWallColors[hit.tag.object];
    // A skirting board is all that is on a wall.
    const float skirting = hit.tag.object <= kWallDoor ? Bar(at.z(), -0.1F, 0.08F, footprint) : 0.0F;
    surface.albedo = Vector3f(color[0], color[1], color[2]) * (1.0F - 0.6F * skirting);
  }
  surface.albedo = surface.albedo.cwiseMax(0.01F);
  return surface;
}

}  // namespace skyquilt::simulate
