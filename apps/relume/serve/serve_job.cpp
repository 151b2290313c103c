#include "serve/serve_job.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <memory>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "cli/console.h"
#include "cli/ocio_option.h"
#include "cli/platform.h"
#include "relume/error.h"
#include "render/settings.h"
#include "serve/allowed_hosts.h"
#include "serve/inbox.h"
#include "serve/model.h"
#include "serve/server.h"
#include "serve/token.h"

namespace relume::cli {
namespace {

constexpr auto kPatience = std::chrono::milliseconds(500);  // for the rendering thread, at the end

std::vector<std::string> names_in(const std::string& list) {
  std::vector<std::string> names;
  for (size_t at = 0; at < list.size();) {
    const size_t comma = std::min(list.find(',', at), list.size());
    if (comma > at) names.push_back(list.substr(at, comma - at));
    at = comma + 1;
  }
  for (const std::string& name : names) {
    if (serve::parse_host(name).host.empty() || !serve::parse_host(name).port.empty())
      throw UsageError(
          fmt::format("--host is '{}', but must be a name without port, such as render.example.com", name));
  }
  return names;
}

/// The address for a browser on this machine.
std::string address_of(const ServeOptions& options, int port, const std::string& token) {
  std::string host = options.bind == "0.0.0.0" ? "127.0.0.1" : options.bind == "::" ? "::1" : options.bind;
  if (host.find(':') != std::string::npos) host = "[" + host + "]";
  return fmt::format("http://{}:{}/#{}", host, port, token);
}

void announce(const ServeOptions& options, int port, const std::string& token) {
  if (!serve::is_loopback(options.bind))
    warn(fmt::format(
        "{} is reachable by other machines, and the connection is not encrypted; use ssh -L {}:127.0.0.1:{} "
        "instead, or put a proxy with TLS in front (docs/serve.md)",
        options.bind, port, port));
  std::puts(address_of(options, port, token).c_str());
  std::fflush(stdout);
}

/// Whether the command line sets a goal of the image, which is then rendered without viewers, too. Goals of presets and
/// files are meant for images that end.
bool asks_for_samples(const ServeOptions& options, const StopSettings& stop) {
  const auto is_given = [&](std::string_view name) {
    return std::any_of(options.flags.begin(), options.flags.end(),
                       [&](const auto& flag) { return flag.first == name; });
  };
  return (stop.spp > 0 && is_given("spp")) || (stop.time_s > 0 && is_given("time")) ||
         (stop.error > 0 && is_given("error"));
}

/// Ends the process at once if the rendering thread is still busy, since its frame has no use.
void stop_rendering(serve::Model& model) {
  auto stopped = std::async(std::launch::async, [&model] { model.renderer().stop(); });
  if (stopped.wait_for(kPatience) == std::future_status::ready && !model.loading()) return;
  std::fflush(nullptr);
  std::_Exit(kExitDone);
}

}  // namespace

int run_serve(const ServeOptions& options, const Verbosity& verbosity) {
  const SettingSources sources = setting_sources(options);
  const viewer::OcioDisplay ocio(make_ocio_view(options.ocio, options.flags));
  serve::Inbox inbox;
  const std::string token = serve::make_token();
  serve::Server server({.address = options.bind,
                        .port = options.port,
                        .names = names_in(options.hosts),
                        .viewers = options.viewers,
                        .token = token},
                       inbox);
  const ViewerStart start = load_viewer_start(options, sources, verbosity);
  const InterruptGuard interrupt("");
  serve::Model model({.settings = start.settings,
                      .fixed_size = start.chooses_size,
                      .target_hz = options.target_hz,
                      .watch = options.watch,
                      .renders_unwatched = asks_for_samples(options, start.settings.stop)},
                     start.scene, ocio, inbox, server);
  server.start();
  announce(options, server.port(), token);
  model.run(interrupt.token());
  log_info(verbosity, "relume serve: stopped");
  server.stop();
  stop_rendering(model);
  return kExitDone;
}

}  // namespace relume::cli
