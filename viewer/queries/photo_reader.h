// Reads photos on a thread of its own: decoding one takes longer than everybody else may wait for the thread that renders.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "core/image/image.h"

namespace skyquilt::viewer {

struct SmallPhoto {
  image::Image8 rgb;   // empty: see problem
  image::Image8 mask;  // one channel, 0 = ignore; empty: all pixels are used
  std::string problem;
};

// A photo that is being read. Whoever destroys it no longer wants it.
class PhotoToRead {
 public:
  PhotoToRead(std::filesystem::path file, std::filesystem::path mask, int width, int height);
  // False when it is not read yet.
  bool WaitFor(std::chrono::milliseconds time);
  // Once, after WaitFor returned true.
  SmallPhoto Take();

 private:
  friend class PhotoReader;
  void Read();

  const std::filesystem::path file_, mask_;
  const int width_, height_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  SmallPhoto photo_;
};

class PhotoReader {
 public:
  // The one of this process.
  static PhotoReader& Instance();

  // Reads photo and mask and reduces them by averaging areas. mask: may be empty.
  std::shared_ptr<PhotoToRead> Read(std::filesystem::path file, std::filesystem::path mask, int width, int height);

 private:
  PhotoReader();
  ~PhotoReader();
  void Loop();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::weak_ptr<PhotoToRead>> waiting_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace skyquilt::viewer
