#include "ranks/task_pool.h"

#include <cstdio>

#include <fmt/format.h>

#include "cli/command.h"
#include "ranks/launcher.h"

namespace relume::ranks {

TaskPool::TaskPool(size_t tasks) : link_(open_link(find_launch())) {
  if (link_->rank() == 0) server_ = std::thread([this, tasks] { serve(tasks); });
}

TaskPool::~TaskPool() {
  stops_ = true;
  join();
}

/// Deals tasks until each rank has ended.
void TaskPool::serve(size_t tasks) {
  size_t next = 0;
  std::vector<bool> ended(static_cast<size_t>(link_->size()), false);
  for (int left = link_->size(); left > 0;) {
    if (const std::optional<int> lost = link_->lost_rank(); lost && !ended[static_cast<size_t>(*lost)]) {
      std::fputs(fmt::format("relume: rank {} cannot be reached any more; run what is missing again\n", *lost).c_str(),
                 stderr);
      link_->abandon(cli::kExitFailed);
    }
    const std::optional<Message> message = link_->receive_at_coordinator(0.2);
    if (!message) continue;
    if (message->kind == MessageKind::failed) failed_.push_back(MessageReader(message->content).get_text());
    if (message->kind == MessageKind::hello) {
      const bool any = next < tasks && !stops_;
      link_->send(message->from, any ? MessageKind::deal : MessageKind::finish,
                  any ? MessageWriter().put(next).take() : Bytes());
      if (any) ++next;
    }
    if (message->kind != MessageKind::done || ended[static_cast<size_t>(message->from)]) continue;
    ended[static_cast<size_t>(message->from)] = true;
    --left;
  }
}

std::optional<size_t> TaskPool::next() {
  link_->send(0, MessageKind::hello);
  while (true) {
    const std::optional<Message> message = link_->receive_at_worker(1);
    if (!message) continue;
    if (message->kind == MessageKind::finish) return std::nullopt;
    if (message->kind == MessageKind::deal) return MessageReader(message->content).get<size_t>();
  }
}

void TaskPool::failed(const std::string& name) {
  link_->send(0, MessageKind::failed, MessageWriter().put_text(name).take());
}

/// Ends this rank, and then all ranks together.
void TaskPool::join() {
  if (finished_) return;
  finished_ = true;
  link_->send(0, MessageKind::done);
  if (server_.joinable()) {
    server_.join();
    for (int rank = 1; rank < link_->size(); ++rank) link_->send(rank, MessageKind::end);
  } else {
    while (true) {
      const std::optional<Message> message = link_->receive_at_worker(1);
      if (message && message->kind == MessageKind::end) break;
    }
  }
  link_->close(cli::kExitFailed);
}

std::vector<std::string> TaskPool::finish() {
  join();
  return failed_;
}

}  // namespace relume::ranks
