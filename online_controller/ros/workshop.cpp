#include "online_controller_ros/workshop.hpp"

#include <pthread.h>
#include <sys/resource.h>

#include <utility>

namespace polyfly_ros {
namespace {

constexpr int kNice = 10;  // more is less priority

}  // namespace

Workshop::Workshop() : thread_([this] { serve(); }) {
  pthread_setname_np(thread_.native_handle(), "mpc_workshop");
}

Workshop::~Workshop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Workshop::run(const std::function<void()>& work) {
  std::unique_lock<std::mutex> lock(mutex_);
  work_ = &work;
  changed_.notify_all();
  changed_.wait(lock, [this] { return work_ == nullptr; });
  if (thrown_ != nullptr) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void Workshop::serve() {
  setpriority(PRIO_PROCESS, 0, kNice);  // of this thread
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stopping_ || work_ != nullptr; });
    if (stopping_) return;
    lock.unlock();
    std::exception_ptr thrown;
    try {
      (*work_)();
    } catch (...) {
      thrown = std::current_exception();
    }
    lock.lock();
    thrown_ = thrown;
    work_ = nullptr;
    changed_.notify_all();
  }
}

}  // namespace polyfly_ros
