#include "report/page.h"

#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace relume {
namespace {

/// Data of a page, in the form that its script reads.
nlohmann::json data_of(const std::string& html) {
  const std::string begin = "id=\"page-data\">";
  const size_t at = html.find(begin) + begin.size();
  return nlohmann::json::parse(html.substr(at, html.find("</script>", at) - at));
}

TEST(Page, TextCannotEndTheScript) {
  const std::string evil = "</script><script>alert(1)</script><!-- &";
  const std::string html = to_html({evil, evil, {TextBlock{evil, evil, {evil}}}});
  EXPECT_EQ(html.find("alert(1)</script>"), std::string::npos);
  EXPECT_NE(html.find("<title>&lt;/script&gt;"), std::string::npos);
  const auto data = data_of(html);
  EXPECT_EQ(data["title"], evil);
  EXPECT_EQ(data["blocks"][0]["points"][0], evil);
}

TEST(Page, IsOneFile) {
  const std::string html = to_html({"t", "s", {}});
  EXPECT_FALSE(std::regex_search(html, std::regex("@[A-Z_]+@"))) << "a placeholder is not filled";
  for (const char* part : {"relume.start()", "relume.Viewer", "prefers-color-scheme", "page-data"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  EXPECT_EQ(html.find(" src=\"http"), std::string::npos);
  EXPECT_EQ(html.find("<link"), std::string::npos);
  EXPECT_EQ(html.find("@import"), std::string::npos);
}

TEST(Page, NonFiniteNumbersBecomeNull) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Chart chart{"l", "x", "y", true, true, {{"c", 0, false, {{1, 2}, {2, nan}, {3, 4, 3, 5}}}}};
  TableBlock table{"t", "", "r", {{"a"}}, {{"row", 0, {{"–", nan}}}}};
  const auto data = data_of(to_html({"t", "s", {ChartBlock{"c", "", {chart}}, table}}));
  const auto& points = data["blocks"][0]["charts"][0]["curves"][0]["points"];
  EXPECT_EQ(points[0].size(), 2u);
  EXPECT_TRUE(points[1][1].is_null());
  EXPECT_EQ(points[2], nlohmann::json({3.0, 4.0, 3.0, 5.0}));
  EXPECT_FALSE(data["blocks"][1]["rows"][0]["cells"][0].contains("value"));
}

TEST(Page, TheSamePageGivesTheSameBytes) {
  const Page page{"t", "s", {ClaimBlock{"c", "", {{"id", "p", "c", "m", "t", kVerdictHolds}}}}};
  EXPECT_EQ(to_html(page), to_html(page));
}

}  // namespace
}  // namespace relume
