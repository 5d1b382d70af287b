// A thread on which DataSource is called, one request after the other, so that decoding a photo does not hold up the server's own thread.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "viewer/server/server.h"

namespace skyquilt::viewer::server {

class DataThread {
 public:
  using Post = std::function<void(std::function<void()>)>;
  using Done = std::function<void(DataReply)>;

  // post: runs a function on the server's thread.
  DataThread(DataSource& source, Post post);
  ~DataThread();
  DataThread(const DataThread&) = delete;
  DataThread& operator=(const DataThread&) = delete;

  // done is called by `post`. A source that throws is answered with status 500.
  void Get(std::string path, std::string query, Done done);
  void Put(std::string path, std::string body, std::string if_match, Done done);
  // Drops what waits and waits for the call that runs.
  void Stop();

 private:
  struct Job {
    bool put = false;
    std::string path, text, if_match;
    Done done;
  };
  void Add(Job job);
  void Run();
  DataReply Answer(const Job& job) const;

  DataSource& source_;
  Post post_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace skyquilt::viewer::server
