#include "serve/allowed_hosts.h"

#include <string>

#include <gtest/gtest.h>

namespace relume::serve {
namespace {

TEST(AllowedHosts, ParsesNamesAndPorts) {
  EXPECT_EQ(parse_host("Render.Example.com:8464").host, "render.example.com");
  EXPECT_EQ(parse_host("Render.Example.com:8464").port, "8464");
  EXPECT_EQ(parse_host("[::1]:80").host, "::1");
  EXPECT_EQ(parse_host("[::1]").port, "");
  for (const char* bad : {"", ":80", "a b", "a:", "a:b", "a:123456", "[::1", "[x]", "[1.2.3.4]", "::1", "a/b", "a@b",
                          "a:80:80", "a\r\nb", "[::1]80"})
    EXPECT_EQ(parse_host(bad).host, "") << bad;
  EXPECT_EQ(parse_host(std::string(300, 'a')).host, "");
}

TEST(AllowedHosts, LoopbackHasItsNamesOnly) {
  const AllowedHosts hosts("127.0.0.1", {});
  for (const char* name : {"127.0.0.1:8464", "localhost:9000", "LOCALHOST", "[::1]:1"})
    EXPECT_TRUE(hosts.allows_host(name)) << name;
  for (const char* name : {"evil.example:8464", "127.0.0.1.evil.example", "10.0.0.1:8464", "localhost.evil.example", "",
                           "localhost:8464, evil.example", "127.1", "2130706433"})
    EXPECT_FALSE(hosts.allows_host(name)) << name;
}

TEST(AllowedHosts, AllAddressesAllowNumbersButNoNames) {
  const AllowedHosts hosts("0.0.0.0", {"Render.example.com"});
  EXPECT_TRUE(hosts.allows_host("10.0.0.1:8464"));
  EXPECT_TRUE(hosts.allows_host("render.example.com"));
  EXPECT_FALSE(hosts.allows_host("evil.example:8464"));
  EXPECT_TRUE(AllowedHosts("127.0.0.1", {"[2001:db8::1]"}).allows_host("[2001:DB8::1]:80"));
  const AllowedHosts one("192.168.1.5", {});
  EXPECT_TRUE(one.allows_host("192.168.1.5:8464"));
  EXPECT_FALSE(one.allows_host("192.168.1.6:8464"));
}

TEST(AllowedHosts, ThePageComesFromTheSameHostAndPort) {
  const AllowedHosts hosts("127.0.0.1", {"render.example.com"});
  EXPECT_TRUE(hosts.allows_origin("http://127.0.0.1:8464", "127.0.0.1:8464"));
  EXPECT_TRUE(hosts.allows_origin("https://render.example.com", "render.example.com"));
  EXPECT_FALSE(hosts.allows_origin("http://localhost:3000", "localhost:8464"));
  EXPECT_FALSE(hosts.allows_origin("http://127.0.0.1:8464", "localhost:8464"));
  EXPECT_FALSE(hosts.allows_origin("http://evil.example:8464", "evil.example:8464"));
  for (const char* bad : {"", "null", "file://", "127.0.0.1:8464", "http://127.0.0.1:8464/", "http://a@127.0.0.1:8464",
                          "ws://127.0.0.1:8464", "http://127.0.0.1:8464 http://evil.example"})
    EXPECT_FALSE(hosts.allows_origin(bad, "127.0.0.1:8464")) << bad;
}

TEST(AllowedHosts, KnowsTheLoopbackInterface) {
  for (const char* address : {"127.0.0.1", "127.8.8.8", "::1"}) EXPECT_TRUE(is_loopback(address)) << address;
  for (const char* address : {"0.0.0.0", "::", "10.0.0.1", "localhost", ""})
    EXPECT_FALSE(is_loopback(address)) << address;
}

}  // namespace
}  // namespace relume::serve
