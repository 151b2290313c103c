// Model of a frame on any number of threads: steps with barriers between them, each with serial work and tasks.
#pragma once

#include <algorithm>
#include <functional>
#include <queue>
#include <vector>

namespace relume::support {

/// Serial work, then tasks that may run at once. All tasks end before the next step begins.
struct TaskStep {
  double serial_s = 0;
  std::vector<double> tasks_s = {};
};

/// Time until the last task has ended, if each thread takes the next task as soon as it is free.
inline double schedule_s(const std::vector<double>& tasks_s, int threads) {
  std::priority_queue<double, std::vector<double>, std::greater<>> free_s;  // when each thread becomes free
  for (int i = 0; i < threads; ++i) free_s.push(0);
  double length_s = 0;
  for (const double task_s : tasks_s) {
    const double end_s = free_s.top() + task_s;
    free_s.pop();
    free_s.push(end_s);
    length_s = std::max(length_s, end_s);
  }
  return length_s;
}

/// Share of the time of `threads` threads in which they wait for others.
inline double idle_share(const std::vector<TaskStep>& steps, int threads) {
  double elapsed_s = 0;
  double busy_s = 0;
  for (const TaskStep& step : steps) {
    elapsed_s += step.serial_s + schedule_s(step.tasks_s, threads);
    busy_s += step.serial_s;
    for (const double task_s : step.tasks_s) busy_s += task_s;
  }
  return elapsed_s > 0 ? 1 - busy_s / (threads * elapsed_s) : 0;
}

}  // namespace relume::support
