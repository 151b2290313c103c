#include "ranks/task_pool.h"

#include <cstdio>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/console.h"
#include "core/clock.h"
#include "ranks/launcher.h"
#include "relume/error.h"

namespace relume::ranks {
namespace {

constexpr double kReport_s = 0.5;  // between reports of a task's progress

}  // namespace

TaskPool::TaskPool(std::string remedy)
    : link_(open_link(find_launch(), remedy)), remedy_(std::move(remedy)), hosts_(static_cast<size_t>(link_->size())) {}

TaskPool::~TaskPool() {
  if (!ended_) end(cli::kExitFailed);
}

std::string TaskPool::name_of(int rank) const {
  const std::string& host = hosts_[static_cast<size_t>(rank)];
  return host.empty() ? fmt::format("rank {}", rank) : fmt::format("rank {} on {}", rank, host);
}

std::optional<std::vector<std::string>> TaskPool::gather(const SharedTasks& work, const std::stop_token& stop) {
  if (first_has_ended_) return std::nullopt;
  std::stop_source source;
  const std::stop_callback stops(stop, [&source] { source.request_stop(); });
  link_->on_interrupt([&source](const Message& message) {
    if (message.kind == MessageKind::cancel) source.request_stop();
  });
  Stage stage{.dealer = TaskDealer(work.tasks.size(), link_->size(), work.ranks),
              .results = std::vector<std::string>(work.tasks.size())};
  std::thread server;
  if (is_first()) server = std::thread([&] { serve(work, stop, stage); });
  const bool is_complete = work_until_finish(work, source.get_token());
  if (server.joinable()) server.join();
  link_->on_interrupt({});
  if (!stage.problem.empty()) {
    if (stage.problem_rank == 0 && failure_) std::rethrow_exception(failure_);
    throw Error(fmt::format("{}: {}", name_of(stage.problem_rank), stage.problem));
  }
  if (!is_complete) return std::nullopt;
  return is_first() ? std::move(stage.results) : std::vector<std::string>();
}

/// Ends the job if a rank is lost.
void TaskPool::check_ranks() const {
  const std::optional<int> lost = link_->lost_rank();
  if (!lost) return;
  std::fputs(fmt::format("relume: {} cannot be reached any more; {}\n", name_of(*lost), remedy_).c_str(), stderr);
  link_->abandon(cli::kExitFailed);
}

/// Deals the tasks of a stage until all ranks wait.
void TaskPool::serve(const SharedTasks& work, const std::stop_token& stop, Stage& stage) {
  while (!stage.dealer.is_over()) {
    check_ranks();
    if (!stage.cancelled && (stop.stop_requested() || stage.stopped || !stage.problem.empty())) {
      stage.cancelled = true;
      stage.dealer.cancel();
      for (int rank = 0; rank < link_->size(); ++rank) link_->send(rank, MessageKind::cancel);
    }
    if (const std::optional<Message> message = link_->receive_at_coordinator(0.2)) take(*message, stage);
    for (const TaskDealer::Deal& deal : stage.dealer.deal())
      link_->send(deal.rank, MessageKind::deal, MessageWriter().put(deal.task).put(work.tasks[deal.task]).take());
    if (work.progress) work.progress(stage.dealer.fraction());
  }
  for (int rank = 0; rank < link_->size(); ++rank)
    link_->send(rank, MessageKind::finish, MessageWriter().put(stage.dealer.is_complete()).take());
}

void TaskPool::take(const Message& message, Stage& stage) {
  MessageReader in(message.content);
  switch (message.kind) {
    case MessageKind::hello:
      hosts_[static_cast<size_t>(message.from)] = in.get_text();
      return stage.dealer.wait(message.from, hosts_[static_cast<size_t>(message.from)]);
    case MessageKind::progress: return stage.dealer.note_progress(message.from, in.get<double>());
    case MessageKind::result: {
      const auto task = in.get<size_t>();
      stage.results.at(task) = in.get_text();
      return stage.dealer.note_result();
    }
    case MessageKind::failed: {
      const std::string problem = in.get_text();
      stage.stopped = true;
      if (!stage.problem.empty() || problem.empty()) return;
      stage.problem = problem;
      stage.problem_rank = message.from;
      return;
    }
    case MessageKind::done: return stage.dealer.leave(message.from);
    default: return;
  }
}

/// The next message for this rank's part. After `end`, none follows.
Message TaskPool::next_message() {
  while (true) {
    std::optional<Message> message = link_->receive_at_worker(1);
    if (!message || message->kind == MessageKind::cancel) continue;
    if (message->kind == MessageKind::end) first_has_ended_ = MessageReader(message->content).get<int>();
    return std::move(*message);
  }
}

/// Runs the tasks that are dealt to this rank. Returns whether the stage is complete.
bool TaskPool::work_until_finish(const SharedTasks& work, const std::stop_token& stop) {
  while (true) {
    link_->send(0, MessageKind::hello, MessageWriter().put_text(host_name()).take());
    const Message message = next_message();
    if (message.kind == MessageKind::deal) {
      run_task(message, work, stop);
    } else {
      return message.kind == MessageKind::finish && MessageReader(message.content).get<bool>();
    }
  }
}

void TaskPool::run_task(const Message& deal, const SharedTasks& work, const std::stop_token& stop) {
  MessageReader in(deal.content);
  const auto position = in.get<size_t>();
  const auto task = in.get<size_t>();
  double reported_s = now_s();
  const auto report = [&](double fraction) {
    if (now_s() - reported_s < kReport_s) return;
    reported_s = now_s();
    link_->send(0, MessageKind::progress, MessageWriter().put(fraction).take());
  };
  std::string problem;
  try {
    if (const std::optional<std::string> result = work.run(task, stop, report)) {
      link_->send(0, MessageKind::result, MessageWriter().put(position).put_text(*result).take());
      return;
    }
  } catch (const std::exception& error) {
    if (!failure_) failure_ = std::current_exception();
    problem = error.what();
  }
  link_->send(0, MessageKind::failed, MessageWriter().put_text(problem).take());
}

std::optional<std::string> TaskPool::share(std::string bytes) {
  if (first_has_ended_) return std::nullopt;
  if (is_first()) {
    for (int rank = 1; rank < link_->size(); ++rank)
      link_->send(rank, MessageKind::shared, MessageWriter().put_text(bytes).take());
    return bytes;
  }
  const Message message = next_message();
  if (message.kind != MessageKind::shared) return std::nullopt;
  return MessageReader(message.content).get_text();
}

int TaskPool::end_with_error(const std::string& sentence, int exit_code) {
  if (is_first()) {
    std::fputs(fmt::format("relume: {}\n", cli::printable(sentence)).c_str(), stderr);
  } else {
    link_->send(0, MessageKind::failed, MessageWriter().put_text(sentence).take());
  }
  return end(exit_code);
}

int TaskPool::run_and_end(const std::function<int()>& part) {
  try {
    return end(part());
  } catch (const cli::UsageError& error) {
    return end_with_error(error.what(), cli::kExitUsage);
  } catch (const std::exception& error) {
    return end_with_error(error.what(), cli::kExitFailed);
  }
}

int TaskPool::end(int exit_code) {
  ended_ = true;
  if (is_first()) {
    for (int rank = 1; rank < link_->size(); ++rank)
      link_->send(rank, MessageKind::end, MessageWriter().put(exit_code).take());
  } else {
    link_->send(0, MessageKind::done);
    while (!first_has_ended_) next_message();
    exit_code = *first_has_ended_;
  }
  link_->close(exit_code);
  return exit_code;
}

}  // namespace relume::ranks
