#include "online_controller_ros/vigil.hpp"

#include <pthread.h>
#include <sched.h>

#include "online_controller_ros/callback_thread.hpp"

namespace polyfly_ros {

Vigil::Vigil() {
  sem_init(&begun_, 0, 0);
  thread_ = std::thread([this] { watch(); });
  pthread_setname_np(thread_.native_handle(), "mpc_vigil");
}

Vigil::~Vigil() {
  stopping_ = true;
  end();
  sem_post(&begun_);
  thread_.join();
  sem_destroy(&begun_);
}

void Vigil::keep(int core, Clock::time_point until) noexcept {
  core_.store(core, std::memory_order_relaxed);
  until_.store(until, std::memory_order_relaxed);
  sem_post(&begun_);
}

void Vigil::watch() noexcept {
  const sched_param none{};
  if (pthread_setschedparam(pthread_self(), SCHED_IDLE, &none) != 0) return;  // never in anybody's way
  int here = -1;
  while (!stopping_) {
    if (sem_wait(&begun_) != 0) continue;  // a signal
    const int core = core_.load(std::memory_order_relaxed);
    if (core != here && runOn(core).empty()) here = core;
    if (core != here) continue;  // elsewhere it would be of no use
    while (Clock::now() < until_.load(std::memory_order_relaxed)) relax();
  }
}

}  // namespace polyfly_ros
