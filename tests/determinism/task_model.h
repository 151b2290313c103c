// Model of a frame on any number of threads: steps with barriers between them, each of tasks that may run at once.
#pragma once

#include <algorithm>
#include <functional>
#include <queue>
#include <vector>

namespace relume::support {

/// Costs of the tasks of a step, in the order in which threads take them. All end before the next step begins.
using TaskStep = std::vector<double>;

/// Cost until the last task has ended, if each of `threads` threads takes the next task as soon as it is free.
inline double schedule(const TaskStep& tasks, int threads) {
  std::priority_queue<double, std::vector<double>, std::greater<>> free;  // when each thread becomes free
  for (int i = 0; i < threads; ++i) free.push(0);
  double length = 0;
  for (const double cost : tasks) {
    const double end = free.top() + cost;
    free.pop();
    free.push(end);
    length = std::max(length, end);
  }
  return length;
}

/// Share of the time of `threads` threads in which they wait for others.
inline double idle_share(const std::vector<TaskStep>& steps, int threads) {
  double elapsed = 0;
  double busy = 0;
  for (const TaskStep& step : steps) {
    elapsed += schedule(step, threads);
    for (const double cost : step) busy += cost;
  }
  return elapsed > 0 ? 1 - busy / (threads * elapsed) : 0;
}

}  // namespace relume::support
