#include "ranks/ranks_job.h"

#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "cli/console.h"
#include "cli/platform.h"
#include "cli/render_setup.h"
#include "cli/version.h"
#include "parts/sums_file.h"
#include "ranks/frame_job.h"
#include "ranks/hosts.h"
#include "ranks/launcher.h"
#include "ranks/link.h"
#include "ranks/sample_job.h"
#include "ranks/sample_worker.h"
#include "relume/error.h"
#include "render/checkpoint.h"
#include "render/sample_parts.h"
#include "render/session.h"

namespace relume::ranks {
namespace {

using cli::RenderOptions;
using cli::RenderSetup;
using cli::Verbosity;

/// What must be equal on all ranks.
std::string identity_of(const RenderSetup& setup) {
  return fmt::format("{} {:016x} {}", cli::kVersion, setup.session->scene_hash(),
                     checkpoint_key(render_settings(*setup.session)));
}

void check_options(const RenderOptions& options) {
  if (!options.sample_range.empty())
    throw cli::UsageError("--sample-range is for separate jobs; ranks share all samples, so remove it");
  if (!options.display.empty())
    throw cli::UsageError("--display shows the image of one process; remove it for a render on several ranks");
  if (!options.stats.empty() && !options.frames.empty())
    throw cli::UsageError("--stats describes one process; remove it for a sequence on several ranks");
}

/// The options of a rank that writes nothing: the folders of the outputs may be missing on its machine.
RenderOptions options_of_worker(RenderOptions options) {
  std::error_code failure;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(failure);
  if (failure) throw Error("there is no folder for temporary files; set TMPDIR");
  options.output = (folder / std::filesystem::path(options.output).filename()).string();
  options.stats.clear();
  options.checkpoint.clear();
  return options;
}

int run_worker(const RenderOptions& all, RankLink& link, int threads) {
  int exit_code = cli::kExitFailed;
  const cli::InterruptGuard interrupts("");  // rank 0 decides what an interrupt ends
  try {
    const RenderOptions options = options_of_worker(all);
    const Verbosity quiet{.quiet = true};
    RenderSetup setup = set_up_render(options, quiet, make_plan(options), threads);
    link.send(0, MessageKind::hello, hello_message(identity_of(setup)));
    if (options.frames.empty()) {
      SampleWorker(*setup.session, link).run();
    } else {
      run_frame_worker(options, setup, link);
    }
  } catch (const std::exception& error) {
    link.send(0, MessageKind::failed, MessageWriter().put_text(error.what()).take());
  }
  while (true) {
    const std::optional<Message> message = link.receive_at_worker(1);
    if (!message || message->kind != MessageKind::end) continue;
    exit_code = MessageReader(message->content).get<int>();
    break;
  }
  link.close(exit_code);
  return exit_code;
}

/// Ends all ranks together.
void end_all(RankLink& link, int exit_code) {
  for (int rank = 1; rank < link.size(); ++rank) link.send(rank, MessageKind::finish);
  for (int rank = 1; rank < link.size(); ++rank)
    link.send(rank, MessageKind::end, MessageWriter().put(exit_code).take());
  link.close(exit_code);
}

int run_coordinator(const RenderOptions& options, const Verbosity& verbosity, RankLink& link, int threads) {
  check_options(options);
  RenderSetup setup = set_up_render(options, verbosity, make_plan(options), threads);
  const cli::InterruptGuard interrupts(interrupt_notice(verbosity, "this sample"));
  link.send(0, MessageKind::hello, hello_message(identity_of(setup)));
  const RanksRun run{options, verbosity, setup, link, interrupts.token(), identity_of(setup)};
  const RanksEnd end = options.frames.empty() ? run_sample_job(run) : run_frame_job(run);
  if (end.problem.empty()) return end.exit_code;
  std::fputs(fmt::format("relume: {}\n", cli::printable(end.problem)).c_str(), stderr);
  if (link.lost_rank()) link.abandon(cli::kExitFailed);
  return cli::kExitFailed;
}

/// Whether several ranks can continue the render. The scene's own settings are not known yet.
bool can_be_shared(const RenderOptions& options) {
  if (options.checkpoint.empty() || !options.sample_range.empty() || !options.display.empty()) return false;
  if (!options.frames.empty()) return options.stats.empty();
  return sums_refusal(resolve(make_plan(options).sources).render).empty();
}

}  // namespace

bool runs_on_ranks(const RenderOptions& options) {
  const std::optional<Launch> launch = find_launch();
  if (launch && launch->size > 1) return true;
  std::error_code failure;
  const bool has_checkpoint = std::filesystem::exists(options.checkpoint, failure);
  if (has_checkpoint && options.sample_range.empty()) {
    return is_sums_file(options.checkpoint) || is_sequence_file(options.checkpoint);
  }
  return launch && !has_checkpoint && can_be_shared(options);
}

int run_on_ranks(const RenderOptions& options, const Verbosity& verbosity) {
  const std::optional<Launch> launch = find_launch();
  std::unique_ptr<RankLink> link;
  try {
    link = open_link(launch, way_to_continue(options));
  } catch (const Error&) {
    if (!launch || launch->rank == 0) throw;
    return cli::kExitFailed;  // rank 0 has the same error
  }
  const int threads = launch && launch->size > 1 ? threads_of_rank(*launch) : 0;
  if (link->rank() > 0) return run_worker(options, *link, threads);
  try {
    const int exit_code = run_coordinator(options, verbosity, *link, threads);
    end_all(*link, exit_code);
    return exit_code;
  } catch (const cli::UsageError& error) {
    std::fputs(fmt::format("relume: {}\n", cli::printable(error.what())).c_str(), stderr);
    end_all(*link, cli::kExitUsage);
    return cli::kExitUsage;
  } catch (const std::exception& error) {
    std::fputs(fmt::format("relume: {}\n", cli::printable(error.what())).c_str(), stderr);
    if (link->lost_rank()) link->abandon(cli::kExitFailed);
    end_all(*link, cli::kExitFailed);
    return cli::kExitFailed;
  }
}

}  // namespace relume::ranks
