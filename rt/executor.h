// How independent pieces of work (sampler streams, odd or even windows) are handed to workers. The
// planner sees only this interface, so a serial run and a pool of pinned threads are the same code.
// Contract: `run` returns after every index in [0, num_tasks) was done exactly once; a worker index
// is in [0, num_workers()) and is used by one thread at a time, so it may own scratch memory.
// Results must not depend on which worker does what.
#pragma once

#include "rt/annotations.h"

namespace sopt {

// A borrowed callable `void(int i_worker, int i_task)`; it must outlive the call of `run`.
class Task {
 public:
  template <class F>
  explicit Task(F& callable) noexcept
      : context_(&callable), call_([](void* context, int i_worker, int i_task) noexcept {
          (*static_cast<F*>(context))(i_worker, i_task);
        }) {}

  void operator()(int i_worker, int i_task) const SOPT_RT { call_(context_, i_worker, i_task); }

 private:
  void* context_;
  void (*call_)(void* context, int i_worker, int i_task) noexcept;
};

class Executor {
 public:
  Executor() = default;
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;
  virtual ~Executor() = default;

  [[nodiscard]] virtual int num_workers() const noexcept = 0;
  virtual void run(Task task, int num_tasks) SOPT_RT = 0;
};

// Runs tasks in index order on the calling thread.
class SerialExecutor final : public Executor {
 public:
  [[nodiscard]] int num_workers() const noexcept override { return 1; }
  void run(Task task, int num_tasks) SOPT_RT override {
    for (int i = 0; i < num_tasks; ++i) task(0, i);
  }
};

}  // namespace sopt
