// Interface between the surface and what fuses pieces of its mesh elsewhere: on other ranks.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

namespace skyquilt::surface {

class PieceService {
 public:
  // Gets the index of a piece whose file is there.
  using Made = std::function<void(size_t piece)>;

  PieceService() = default;
  virtual ~PieceService() = default;
  PieceService(const PieceService&) = delete;
  PieceService& operator=(const PieceService&) = delete;

  // How many pieces can be made at the same time, and with how much memory each at most.
  virtual int Makers() const = 0;
  virtual double MemoryBytes() const = 0;
  // Makes these pieces of a job (file of PieceFuser::Write), in any order; `made` is called by the thread that called this. Pieces that nobody could
  // make are left to the caller, with a warning that says why. Throws base::Interrupted and what `made` throws.
  virtual void Make(const std::filesystem::path& job, std::span<const size_t> pieces, const Made& made) = 0;
};

}  // namespace skyquilt::surface
