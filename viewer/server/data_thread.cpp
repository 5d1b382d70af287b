#include "viewer/server/data_thread.h"

#include <exception>
#include <utility>

#include "core/base/log.h"

namespace skyquilt::viewer::server {

DataThread::DataThread(DataSource& source, Post post) : source_(source), post_(std::move(post)), thread_([this] { Run(); }) {}

DataThread::~DataThread() {
  Stop();
}

void DataThread::Get(std::string path, std::string query, Done done) {
  Add({.put = false, .path = std::move(path), .text = std::move(query), .if_match = {}, .done = std::move(done)});
}

void DataThread::Put(std::string path, std::string body, std::string if_match, Done done) {
  Add({.put = true, .path = std::move(path), .text = std::move(body), .if_match = std::move(if_match), .done = std::move(done)});
}

void DataThread::Add(Job job) {
  const std::lock_guard lock(mutex_);
  if (stopping_) return;
  jobs_.push_back(std::move(job));
  changed_.notify_one();
}

void DataThread::Stop() {
  std::deque<Job> dropped;  // destroyed without the lock: a job keeps its connection alive
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    dropped.swap(jobs_);
    changed_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
}

DataReply DataThread::Answer(const Job& job) const {
  const auto failed = [&job](const char* what) {
    base::LogError("viewer: /data/{}: {}", job.path, what);
    return DataReply{.status = 500,
                     .content_type = "text/plain; charset=utf-8",
                     .body = "the viewer could not answer this request; the terminal where it runs says why\n",
                     .file = {}};
  };
  try {
    return job.put ? source_.Put(job.path, job.text, job.if_match) : source_.Get(job.path, job.text);
  } catch (const std::exception& error) {
    return failed(error.what());
  } catch (...) {
    return failed("unknown error");
  }
}

void DataThread::Run() {
  for (;;) {
    Job job;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
      if (stopping_) return;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    auto reply = std::make_shared<DataReply>(Answer(job));
    job.text = {};  // an upload's bytes, before the next one may come
    post_([done = std::move(job.done), reply] { done(std::move(*reply)); });
  }
}

}  // namespace skyquilt::viewer::server
