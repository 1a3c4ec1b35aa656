#include "online_controller_ros/callback_thread.hpp"

#include <pthread.h>
#include <ros/init.h>

#include <algorithm>
#include <utility>

namespace polyfly_ros {
namespace {

std::unique_lock<polyfly::TryLock> locked(polyfly::TryLock* lock) {
  return lock == nullptr ? std::unique_lock<polyfly::TryLock>() : std::unique_lock<polyfly::TryLock>(*lock);
}

}  // namespace

void WaitableQueue::addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) {
  ros::CallbackQueue::addCallback(guarded(callback), owner_id);
  // Whoever has found the queue empty waits by now, and is woken.
  { const std::lock_guard<std::mutex> lock(mutex_); }
  added_.notify_one();
}

void WaitableQueue::waitUntil(Clock::time_point time) {
  std::unique_lock<std::mutex> lock(mutex_);
  added_.wait_until(lock, time, [this] { return !isEmpty(); });
}

CallbackThread::CallbackThread(WaitableQueue& queue, const char* name, Tasks tasks)
    : thread_([this, &queue, tasks = std::move(tasks)] {
        if (tasks.begin) tasks.begin();
        serve(queue, tasks);
      }) {
  pthread_setname_np(thread_.native_handle(), name);
}

void CallbackThread::serve(WaitableQueue& queue, const Tasks& tasks) const {
  using Clock = WaitableQueue::Clock;
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(tasks.period));
  Clock::time_point next = Clock::now() + period;
  while (!stopping_ && ros::ok()) {
    if (queue.isEmpty()) {
      queue.waitUntil(next);
    } else {
      const auto lock = locked(tasks.lock);
      queue.callOne();
    }
    const Clock::time_point now = Clock::now();
    if (now < next) continue;
    next = std::max(next + period, now);
    if (!tasks.tick) continue;
    const auto lock = locked(tasks.lock);
    runGuarded(tasks.tick);
  }
}

CallbackThread::~CallbackThread() {
  stopping_ = true;
  thread_.join();
}

}  // namespace polyfly_ros
