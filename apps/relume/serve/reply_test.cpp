#include "serve/reply.h"

#include <gtest/gtest.h>

#include "serve/page_files.h"

namespace relume::serve {
namespace {

constexpr const char* kHost = "127.0.0.1:8464";
constexpr const char* kOrigin = "http://127.0.0.1:8464";

class Replies : public ::testing::Test {
 protected:
  Reply get(std::string_view target) const {
    return answer({.method = "GET", .target = target, .host = kHost, .origin = ""}, hosts_);
  }
  AllowedHosts hosts_{"127.0.0.1", {}};
};

TEST_F(Replies, ServeTheFilesOfThePage) {
  for (const PageFile& file : kPageFiles) {
    const Reply reply = get(file.target);
    EXPECT_EQ(reply.status, 200u) << file.target;
    EXPECT_EQ(reply.body, file.body);
    EXPECT_GT(reply.body.size(), 100u);
    EXPECT_FALSE(reply.upgrades);
  }
  EXPECT_EQ(get("/").type, "text/html; charset=utf-8");
  EXPECT_EQ(get("/main.js").type, "text/javascript; charset=utf-8");
}

TEST_F(Replies, ServeNothingElse) {
  for (const char* target : {"/index.html", "/main.js/", "//", "/../etc/passwd", "/%2e%2e/etc/passwd", "/main.js?x=1",
                             "/MAIN.JS", "", "main.js", "http://127.0.0.1:8464/main.js", "/..\\main.js", "/socket",
                             "/style.css#x", "*", "/./main.js", "/%6dain.js"})
    EXPECT_EQ(get(target).status, 404u) << target;
}

TEST_F(Replies, CheckTheHost) {
  for (const char* host : {"", "evil.example", "evil.example:8464", "10.0.0.1:8464"})
    EXPECT_EQ(answer({.method = "GET", .target = "/", .host = host, .origin = ""}, hosts_).status, 421u) << host;
}

TEST_F(Replies, OnlyReadsAreAnswered) {
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "TRACE", "get", ""})
    EXPECT_EQ(answer({.method = method, .target = "/", .host = kHost, .origin = ""}, hosts_).status, 405u) << method;
  const Reply head = answer({.method = "HEAD", .target = "/", .host = kHost, .origin = ""}, hosts_);
  EXPECT_EQ(head.status, 200u);
  EXPECT_TRUE(head.body.empty());
}

TEST_F(Replies, UpgradesNeedTheTargetAndTheOrigin) {
  const auto upgrade = [&](std::string_view target, std::string_view origin, std::string_view host = kHost) {
    return answer({.method = "GET", .target = target, .host = host, .origin = origin, .upgrades = true}, hosts_);
  };
  EXPECT_TRUE(upgrade("/socket", kOrigin).upgrades);
  EXPECT_EQ(upgrade("/socket", kOrigin).status, 101u);
  EXPECT_EQ(upgrade("/", kOrigin).status, 404u);
  EXPECT_EQ(upgrade("/socket?token=1", kOrigin).status, 404u);
  for (const char* origin : {"", "null", "http://evil.example", "http://localhost:8464", "http://127.0.0.1"}) {
    EXPECT_EQ(upgrade("/socket", origin).status, 403u) << origin;
    EXPECT_FALSE(upgrade("/socket", origin).upgrades) << origin;
  }
  EXPECT_EQ(upgrade("/socket", "http://evil.example", "evil.example").status, 421u);
}

TEST_F(Replies, ThePageNeedsNoOtherServer) {
  for (const PageFile& file : kPageFiles) {
    EXPECT_EQ(file.body.find("http://"), std::string_view::npos) << file.target;
    EXPECT_EQ(file.body.find("https://"), std::string_view::npos) << file.target;
    EXPECT_EQ(file.body.find("style=\""), std::string_view::npos) << "blocked by the policy: " << file.target;
  }
}

}  // namespace
}  // namespace relume::serve
