#include "serve/message.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relume/error.h"
#include "serve/limits.h"

namespace relume::serve {
namespace {

template <typename T>
T parsed(const std::string& text) {
  return std::get<T>(parse_message(text).body);
}

TEST(Message, EveryKindIsRead) {
  EXPECT_EQ(parsed<Hello>(R"({"do":"hello","token":"abc"})").token, "abc");
  EXPECT_EQ(parsed<Acknowledge>(R"({"do":"ack","frame":4294967295})").frame, 4294967295u);
  const Fly fly = parsed<Fly>(R"({"do":"fly","x":-1,"y":0.5,"z":1,"fast":true})");
  EXPECT_EQ(fly.axes, Vec3(-1, 0.5f, 1));
  EXPECT_TRUE(fly.fast);
  const Drag drag = parsed<Drag>(R"({"do":"drag","pan":true,"x":0.25,"y":-2})");
  EXPECT_TRUE(drag.pan);
  EXPECT_EQ(drag.by, Vec2(0.25f, -2));
  EXPECT_EQ(parsed<Wheel>(R"({"do":"wheel","notches":-1.5})").notches, -1.5f);
  const ChangeSetting set = parsed<ChangeSetting>(R"({"do":"set","side":1,"name":"denoise","value":"svgf"})");
  EXPECT_EQ(set.side, 1);
  EXPECT_EQ(set.name, "denoise");
  EXPECT_EQ(set.value, "svgf");
  EXPECT_EQ(parsed<ApplyPreset>(R"({"do":"preset","side":0,"name":"preview"})").name, "preview");
  EXPECT_EQ(parsed<ShowBuffer>(R"({"do":"buffer","name":""})").name, "");
  EXPECT_EQ(parsed<MoveSplit>(R"({"do":"split-at","at":0.25})").at, 0.25f);
  EXPECT_EQ(parsed<Resize>(R"({"do":"resize","width":640,"height":360})").height, 360);
  EXPECT_EQ(parsed<UseBookmark>(R"({"do":"bookmark","verb":"store","slot":2})").verb, BookmarkVerb::store);
  EXPECT_EQ(parsed<Press>(R"({"do":"press","button":"swap"})").button, Button::swap);
  EXPECT_EQ(parsed<GrantSteering>(R"({"do":"grant","viewer":3})").viewer, 3u);
  parsed<TakeScreenshot>(R"({"do":"screenshot"})");
  parsed<RequestSteering>(R"({"do":"steer"})");
  parsed<Still>(R"( {"do" : "still"} )");
  EXPECT_EQ(parse_message(R"({"do":"still","n":7})").number, 7u);
}

TEST(Message, OthersAreRefused) {
  const std::vector<std::string> bad = {
      "",
      "null",
      "[]",
      "\"do\"",
      "7",
      "{",
      "{}",
      R"({"do":7})",
      R"({"do":"fly"})",
      R"({"do":"nothing"})",
      R"({"do":"left"})",
      R"({"do":"still"} {})",
      R"({"do":"still","more":1})",
      R"({"do":"still","n":-1})",
      R"({"do":"still","n":1.5})",
      R"({"do":"still","n":4294967296})",
      R"({"do":"still","n":"1"})",
      R"({"do":"ack","frame":1e400})",
      R"({"do":"ack","frame":[]})",
      R"({"do":"ack","frame":[1]})",
      R"({"do":"ack","frame":{"a":1}})",
      R"({"do":"fly","x":2,"y":0,"z":0,"fast":true})",
      R"({"do":"fly","x":NaN,"y":0,"z":0,"fast":true})",
      R"({"do":"fly","x":0,"y":0,"z":0,"fast":1})",
      R"({"do":"set","side":2,"name":"a","value":"b"})",
      R"({"do":"set","side":0,"name":"a","value":1})",
      R"({"do":"press","button":"quit"})",
      R"({"do":"bookmark","verb":"go","slot":64})",
      R"({"do":"bookmark","verb":"go","slot":-1})",
      R"({"do":"resize","width":0,"height":10})",
      R"({"do":"resize","width":10,"height":100000})",
      R"({"do":"buffer","name":")" + std::string(1025, 'a') + "\"}",
      "{\"do\":\"buffer\",\"name\":\"\xff\xfe\"}",
      std::string("{\"do\":\"still\"}\0", 15),
      std::string(kMaxMessageBytes + 1, ' '),
      std::string(8000, '['),
      R"({"do":)" + std::string(8000, '{'),
  };
  for (const std::string& text : bad) EXPECT_THROW(parse_message(text), Error) << text.substr(0, 80);
}

TEST(Message, ManyFieldsAreRefused) {
  std::string text = R"({"do":"still")";
  for (int i = 0; i < 500; ++i) text += ",\"f" + std::to_string(i) + "\":0";
  EXPECT_THROW(parse_message(text + "}"), Error);
}

TEST(Message, OnlyInputSteers) {
  EXPECT_TRUE(steers(Fly{}));
  EXPECT_TRUE(steers(ChangeSetting{}));
  EXPECT_TRUE(steers(Press{}));
  EXPECT_TRUE(steers(GrantSteering{}));
  EXPECT_TRUE(steers(Resize{}));
  EXPECT_FALSE(steers(Acknowledge{}));
  EXPECT_FALSE(steers(TakeScreenshot{}));
  EXPECT_FALSE(steers(RequestSteering{}));
  EXPECT_FALSE(steers(Hello{}));
}

}  // namespace
}  // namespace relume::serve
