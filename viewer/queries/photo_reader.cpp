#include "viewer/queries/photo_reader.h"

#include <exception>
#include <utility>

#include "core/base/errors.h"

namespace skyquilt::viewer {

PhotoToRead::PhotoToRead(std::filesystem::path file, std::filesystem::path mask, int width, int height)
    : file_(std::move(file)), mask_(std::move(mask)), width_(width), height_(height) {}

bool PhotoToRead::WaitFor(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, time, [this] { return done_; });
}

SmallPhoto PhotoToRead::Take() {
  const std::lock_guard lock(mutex_);
  return std::move(photo_);
}

void PhotoToRead::Read() {
  SmallPhoto photo;
  try {
    photo.rgb = image::Resize(image::LoadRgb8(file_), width_, height_);
    if (!mask_.empty()) photo.mask = image::ResizeMask(image::LoadMask(mask_), width_, height_);
  } catch (const base::InputError& error) {
    // Clients need not know folders of this machine.
    photo = {.rgb = {}, .mask = {}, .problem = error.file().filename().string() + ": " + error.finding()};
  } catch (const std::exception& error) {
    photo = {.rgb = {}, .mask = {}, .problem = file_.filename().string() + ": " + error.what()};
  }
  {
    const std::lock_guard lock(mutex_);
    photo_ = std::move(photo);
    done_ = true;
  }
  changed_.notify_all();
}

PhotoReader& PhotoReader::Instance() {
  static PhotoReader reader;
  return reader;
}

PhotoReader::PhotoReader() : thread_([this] { Loop(); }) {}

PhotoReader::~PhotoReader() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::shared_ptr<PhotoToRead> PhotoReader::Read(std::filesystem::path file, std::filesystem::path mask, int width, int height) {
  auto photo = std::make_shared<PhotoToRead>(std::move(file), std::move(mask), width, height);
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(photo);
  }
  changed_.notify_all();
  return photo;
}

void PhotoReader::Loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    if (ending_) return;
    const std::shared_ptr<PhotoToRead> photo = waiting_.front().lock();
    waiting_.pop_front();
    if (photo == nullptr) continue;
    lock.unlock();
    photo->Read();
    lock.lock();
  }
}

}  // namespace skyquilt::viewer
