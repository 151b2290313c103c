#include "serve/reply.h"

#include <algorithm>

#include "serve/page_files.h"

namespace relume::serve {

const PageFile* find_page_file(std::string_view target) {
  const auto found =
      std::find_if(kPageFiles.begin(), kPageFiles.end(), [&](const PageFile& file) { return file.target == target; });
  return found == kPageFiles.end() ? nullptr : &*found;
}

Reply answer(const Request& request, const AllowedHosts& hosts) {
  if (!hosts.allows_host(request.host)) {
    Reply reply{.status = 421};
    reply.body = "This server has another name; add it with --host.\n";
    return reply;
  }
  if (request.method != "GET" && request.method != "HEAD") return {.status = 405};
  if (request.upgrades) {
    if (request.method != "GET" || request.target != kSocketTarget) return {.status = 404};
    const bool allowed = hosts.allows_origin(request.origin, request.host);
    return {.status = allowed ? 101u : 403u, .upgrades = allowed};
  }
  const PageFile* file = find_page_file(request.target);
  if (file == nullptr) return {.status = 404};
  Reply reply{.status = 200, .type = file->type};
  if (request.method == "GET") reply.body = file->body;
  return reply;
}

}  // namespace relume::serve
