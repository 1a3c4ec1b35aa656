#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace polyfly_ros {

/// A thread of less priority than others have, for what computes long. Who talks to roscpp must not have it:
/// roscpp's thread that writes to connections looks without a pause while another is in the middle of that,
/// and takes the lock of all publishers each time.
class Workshop {
 public:
  Workshop();
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;
  ~Workshop();

  /// Does it there, and waits until it is done. Throws what it throws. For one caller at a time.
  void run(const std::function<void()>& work);

 private:
  void serve();

  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void()>* work_ = nullptr;  // the caller's
  std::exception_ptr thrown_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace polyfly_ros
