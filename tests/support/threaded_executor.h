// Runs tasks on threads of their own, made anew in every call: for what must not depend on the
// number of workers or on the order of tasks.
#pragma once

#include <thread>
#include <vector>

#include "rt/executor.h"

namespace sopt {

// As many threads as workers; worker w does every third task from w on.
class ThreadedExecutor final : public Executor {
 public:
  [[nodiscard]] int num_workers() const noexcept override { return 3; }
  void run(Task task, int num_tasks) SOPT_RT override {
    std::vector<std::thread> threads;
    for (int w = 0; w < num_workers(); ++w) {
      threads.emplace_back([=, this] {
        for (int i = w; i < num_tasks; i += num_workers()) task(w, i);
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
};

}  // namespace sopt
