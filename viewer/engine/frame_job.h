// One view that is being rendered for a client, pass by pass, a batch of rays at a time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/engine/pass_rays.h"
#include "viewer/engine/renderer.h"
#include "viewer/protocol/frame.h"

namespace skyquilt::viewer {

// A finished pass, before it is encoded.
struct RenderedPass {
  FrameHeader header;          // without the scene's revision
  std::vector<uint8_t> rgb;    // w * h * 3
  std::vector<float> depth_m;  // w * h, z along the optical axis, NaN: no surface
};

class FrameJob {
 public:
  // Throws BadMessage when the view cannot be rendered.
  FrameJob(const ViewRequest& view, const Renderer& renderer);

  uint32_t seq() const { return view_.seq; }
  Which project() const { return view_.project; }
  int passes() const { return static_cast<int>(sizes_.size()); }
  int pass() const { return pass_; }  // that is being rendered, passes() at the end
  bool Done() const { return pass_ >= passes(); }
  // The same for the same picture of the same scene, whoever asks for it.
  std::string Key(int pass) const;

  // Renders one batch. Returns the pass when it is finished, and goes on to the next one.
  std::optional<RenderedPass> Step(Renderer& renderer);
  // Goes on to this pass, because the earlier ones are no longer needed.
  void SkipTo(int pass);

 private:
  struct Pass;
  void Begin(const Renderer& renderer);

  ViewRequest view_;
  std::vector<PassSize> sizes_;
  int pass_ = 0;
  std::shared_ptr<Pass> current_;  // null until its first batch: waiting jobs take no memory
};

}  // namespace skyquilt::viewer
