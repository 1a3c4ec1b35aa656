#include "online_controller_ros/callback_thread.hpp"

#include <pthread.h>
#include <ros/init.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace polyfly_ros {

CallbackThread::CallbackThread(ThreadQueue& queue, const char* name, std::function<void()> tick,
                               double period)
    : thread_([this, &queue, tick = std::move(tick), period] { serve(queue, tick, period); }) {
  pthread_setname_np(thread_.native_handle(), name);
}

void CallbackThread::serve(ThreadQueue& queue, const std::function<void()>& tick, double period) const {
  using Clock = std::chrono::steady_clock;
  const auto step = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(period));
  Clock::time_point next = Clock::now() + step;
  while (!stopping_ && ros::ok()) {
    const double rest = std::chrono::duration<double>(next - Clock::now()).count();
    queue.callOne(ros::WallDuration(std::max(0.0, rest)));
    const Clock::time_point now = Clock::now();
    if (now < next) continue;
    next = std::max(next + step, now);
    if (tick) runGuarded(tick);
  }
}

CallbackThread::~CallbackThread() {
  stopping_ = true;
  thread_.join();
}

}  // namespace polyfly_ros
