// Elements, parameters, includes, references and limits of Mitsuba's XML.
#include <gtest/gtest.h>

#include "relume/scene_io.h"
#include "scene_io/mitsuba/mitsuba_document.h"
#include "scene_io/mitsuba/mitsuba_xml.h"
#include "scene_io/testing/mitsuba_scene.h"

namespace relume {
namespace {

using testing::error_of;
using testing::load_mitsuba_text;
using testing::mentions;
using testing::SceneFolder;
using testing::to_bytes;

std::string error_of_text(const std::string& elements, const std::filesystem::path& folder = "/nonexistent") {
  return error_of([&] { load_mitsuba_text(elements, folder); });
}

std::string error_of_file(const std::string& xml) {
  return error_of([&] { load_mitsuba_from_memory(to_bytes(xml), "/nonexistent", "a.xml"); });
}

/// Intensity of the scene's point light.
float intensity(const Scene& scene) { return scene.lights.at(0).intensity.x; }

std::string light(const std::string& value) {
  return "<emitter type=\"point\"><float name=\"intensity\" value=\"" + value + "\"/></emitter>";
}

TEST(MitsubaXml, ParametersAreReplaced) {
  EXPECT_EQ(
      intensity(load_mitsuba_text("<default name=\"a\" value=\"1\"/><default name=\"a\" value=\"7\"/>" + light("$a5"))),
      15);  // the first value; the longest known name
  EXPECT_EQ(intensity(load_mitsuba_text("<default name=\"a\" value=\"1\"/><default name=\"ab\" value=\"$a$a\"/>" +
                                        light("$ab.5"))),
            11.5f);
  const std::string undefined = error_of_text("\n" + light("$x"));
  EXPECT_TRUE(undefined.starts_with("a.xml:3: the parameter '$x' has no value")) << undefined;
  mitsuba::Substitution substitution;
  EXPECT_EQ(substitution.apply("\\$5"), "$5");
}

TEST(MitsubaXml, ParametersDoNotGrowWithoutLimit) {
  std::string laughs = "<default name=\"a0\" value=\"ha\"/>";
  for (int i = 1; i < 64; ++i) {
    const std::string before = "$a" + std::to_string(i - 1) + " ";
    laughs += "<default name=\"a" + std::to_string(i) + "\" value=\"" + before + before + "\"/>";
  }
  EXPECT_NE(error_of_text(laughs).find("longer than 1 MiB"), std::string::npos);
  std::string many = "<default name=\"a\" value=\"" + std::string(900000, '1') + "\"/>";
  for (int i = 0; i < 200; ++i) many += "<default name=\"b\" value=\"$a\"/>";
  EXPECT_NE(error_of_text(many).find("longer than 128 MiB"), std::string::npos);
}

TEST(MitsubaXml, EntitiesAreNotExpanded) {
  const Scene scene = load_mitsuba_from_memory(
      to_bytes("<!DOCTYPE s [<!ENTITY a \"aaaaaaaa\"><!ENTITY b \"&a;&a;\">]><scene version=\"3.0.0\"><emitter "
               "type=\"point\" id=\"&b;\"/></scene>"),
      "/nonexistent", "a.xml");
  EXPECT_EQ(scene.lights.at(0).name, "&b;");
}

TEST(MitsubaXml, IncludesScenesAndSingleObjects) {
  const SceneFolder folder;
  std::filesystem::create_directory(folder.path() / "parts");
  folder.write("parts/lamp.xml",
               "<scene version=\"3.0.0\">" + light("$power") + "<include filename=\"deep.xml\"/></scene>");
  folder.write("parts/deep.xml", "<bsdf version=\"3.0.0\" type=\"diffuse\" id=\"red\"/>");
  const std::string text =
      "<default name=\"power\" value=\"3\"/><include filename=\"parts/lamp.xml\"/>"
      "<shape type=\"cube\"><ref id=\"red\"/></shape>";
  const Scene scene = load_mitsuba_text(text, folder.path());
  EXPECT_EQ(intensity(scene), 3);
  EXPECT_EQ(scene.materials.at(0).name, "red");
  folder.write("main.xml", "<scene version=\"3.0.0\">" + text + "</scene>");
  const Scene loaded = load_mitsuba(folder.path() / "main.xml");
  EXPECT_EQ(loaded.materials.size(), 1u);
  folder.write("checks.xml", "<texture version=\"3.0.0\" type=\"checkerboard\"/>");
  const Scene named = load_mitsuba_text(
      "<shape type=\"cube\"><bsdf type=\"diffuse\"><include name=\"reflectance\" "
      "filename=\"checks.xml\"/></bsdf></shape>",
      folder.path());
  EXPECT_TRUE(named.materials.at(0).base_color_texture.used());
}

TEST(MitsubaXml, IncludesAreBounded) {
  const SceneFolder folder;
  folder.write("loop.xml", "<scene version=\"3.0.0\"><include filename=\"loop.xml\"/></scene>");
  EXPECT_NE(error_of_text("<include filename=\"loop.xml\"/>", folder.path()).find("remove the cycle"),
            std::string::npos);
  // Two includes per level, 2^14 files.
  folder.write("l14.xml", "<scene version=\"3.0.0\"/>");
  for (int i = 13; i >= 0; --i) {
    const std::string next = "<include filename=\"l" + std::to_string(i + 1) + ".xml\"/>";
    folder.write("l" + std::to_string(i) + ".xml", "<scene version=\"3.0.0\">" + next + next + "</scene>");
  }
  EXPECT_NE(error_of_text("<include filename=\"l1.xml\"/>", folder.path()).find("more than 1000 files"),
            std::string::npos);
  EXPECT_NE(
      error_of_text("<include filename=\"absent.xml\"/>", folder.path()).find("absent.xml: the file does not exist"),
      std::string::npos);
}

TEST(MitsubaXml, PathsStayInTheScenesFolder) {
  const SceneFolder outer;
  std::filesystem::create_directories(outer.path() / "scene" / "inner");
  outer.write("secret.xml", "<scene version=\"3.0.0\">" + light("9") + "</scene>");
  outer.write("scene/inner/near.xml", "<scene version=\"3.0.0\">" + light("4") + "</scene>");
  const std::filesystem::path folder = outer.path() / "scene";
  for (const std::string& path : {std::string("../secret.xml"), (outer.path() / "secret.xml").string(),
                                  std::string("inner/../../secret.xml"), std::string("..\\secret.xml")})
    EXPECT_NE(error_of_text("<include filename=\"" + path + "\"/>", folder).find("does not exist"), std::string::npos)
        << path;
  const Scene with_path =
      load_mitsuba_text("<path value=\"..\"/><path value=\"inner\"/><include filename=\"near.xml\"/>", folder);
  EXPECT_EQ(intensity(with_path), 4);
  EXPECT_TRUE(mentions(with_path.warnings, "the folder '..' of <path> is not below the scene file's folder"));
}

TEST(MitsubaXml, ReferencesAndAliases) {
  const std::string shape = "<shape type=\"cube\"><ref id=\"late\"/></shape>";
  const std::string bsdf = "<bsdf type=\"diffuse\" id=\"first\"/><alias id=\"first\" as=\"late\"/>";
  EXPECT_EQ(load_mitsuba_text(shape + bsdf).materials.at(0).name, "first");
  EXPECT_TRUE(error_of_text(shape).starts_with("a.xml:2: <ref> names the id 'late'")) << error_of_text(shape);
  EXPECT_NE(error_of_text(bsdf + bsdf).find("the id 'first' is used twice"), std::string::npos);
  EXPECT_NE(error_of_text("<alias id=\"a\" as=\"b\"/>").find("is not defined before it"), std::string::npos);
  EXPECT_NE(error_of_text("<bsdf type=\"twosided\" id=\"a\"><ref id=\"b\"/></bsdf><bsdf type=\"twosided\" "
                          "id=\"b\"><ref id=\"a\"/></bsdf>")
                .find("contains itself"),
            std::string::npos);
}

TEST(MitsubaXml, NestingIsBounded) {
  std::string chain = "<bsdf type=\"diffuse\" id=\"b0\"/>";
  for (int i = 1; i < 100000; ++i)
    chain +=
        "<bsdf type=\"twosided\" id=\"b" + std::to_string(i) + "\"><ref id=\"b" + std::to_string(i - 1) + "\"/></bsdf>";
  EXPECT_NE(error_of_text(chain).find("nest deeper than 32 levels"), std::string::npos);
  std::string deep;
  for (int i = 0; i < 200000; ++i) deep += "<bsdf type=\"twosided\">";
  for (int i = 0; i < 200000; ++i) deep += "</bsdf>";
  EXPECT_NE(error_of_text(deep).find("nest deeper than 64 levels"), std::string::npos);
}

TEST(MitsubaXml, OtherXmlFilesAreRefused) {
  EXPECT_NE(error_of_file("<COLLADA version=\"1.4.1\"/>").find("its root element is <COLLADA>, not <scene>"),
            std::string::npos);
  EXPECT_NE(error_of_file("<scene/>").find("has no version"), std::string::npos);
  EXPECT_NE(error_of_file("<scene version=\"new\"/>").find("'new' is no version"), std::string::npos);
  EXPECT_TRUE(
      error_of_file("<scene version=\"3.0.0\">\n<shape>\n</scene>").starts_with("a.xml:3: the XML is malformed"));
  EXPECT_NE(error_of_file("").find("a.xml:1: the XML is malformed"), std::string::npos);
}

TEST(MitsubaXml, WrongValuesNameTheirPlace) {
  EXPECT_EQ(error_of_text(light("1.5x")),
            "a.xml:2: the value '1.5x' of float 'intensity' is not a finite number; correct it");
  EXPECT_NE(error_of_text(light("nan")).find("'nan'"), std::string::npos);
  EXPECT_NE(error_of_text(light("1e999")).find("'1e999'"), std::string::npos);
  EXPECT_NE(error_of_text("<integrator type=\"path\"><float name=\"max_depth\" value=\"3\"/></integrator>")
                .find("a.xml:2: integrator 'path': 'max_depth' is not an integer"),
            std::string::npos);
  EXPECT_NE(error_of_text("<nonsense name=\"a\"/>").find("<nonsense> is no element of Mitsuba scenes"),
            std::string::npos);
  EXPECT_NE(error_of_text("<shape/>").find("<shape> has no type"), std::string::npos);
  EXPECT_NE(error_of_text("<shape type=\"cube\"><boolean name=\"flip_normals\" value=\"yes\"/></shape>")
                .find("not true or false"),
            std::string::npos);
}

TEST(MitsubaXml, NamesBeforeVersionTwo) {
  const Scene scene = load_mitsuba_from_memory(to_bytes("<scene version=\"0.6.0\"><emitter type=\"spot\"><float "
                                                        "name=\"cutoffAngle\" value=\"45\"/></emitter></scene>"),
                                               "/nonexistent", "a.xml");
  EXPECT_FLOAT_EQ(scene.lights.at(0).outer_cone_rad, kPi / 4);
  const Scene diffuse = load_mitsuba_from_memory(
      to_bytes("<scene version=\"0.6.0\"><shape type=\"cube\"><bsdf type=\"diffuse\"><texture type=\"checkerboard\" "
               "name=\"diffuseReflectance\"><float name=\"uscale\" value=\"3\"/><float name=\"voffset\" "
               "value=\"0.5\"/></texture></bsdf></shape></scene>"),
      "/nonexistent", "a.xml");
  EXPECT_EQ(diffuse.materials.at(0).base_color_texture.scale, Vec2(3, 1));
  EXPECT_EQ(diffuse.materials.at(0).base_color_texture.offset, Vec2(0, 0.5f));
  EXPECT_TRUE(diffuse.warnings.empty());
  EXPECT_EQ(mitsuba::underscore_name("toWorld"), "to_world");
  EXPECT_EQ(mitsuba::underscore_name("intIOR"), "int_ior");
  EXPECT_EQ(mitsuba::underscore_name("alpha"), "alpha");
}

TEST(MitsubaXml, UnknownParametersGiveOneWarning) {
  const std::string sphere = "<shape type=\"sphere\"><float name=\"colour\" value=\"1\"/></shape>";
  const Scene scene =
      load_mitsuba_text(sphere + sphere + "<sensor type=\"radiancemeter\"/><medium type=\"homogeneous\"/>");
  EXPECT_EQ(scene.warnings.size(), 3u);
  EXPECT_TRUE(mentions(scene.warnings, "a.xml: shape 'sphere': its parameter 'colour' is ignored"));
  EXPECT_TRUE(mentions(scene.warnings, "sensor 'radiancemeter' is not supported"));
  EXPECT_TRUE(mentions(scene.warnings, "medium 'homogeneous' is ignored"));
}

TEST(MitsubaXml, MissingFilesAreRecorded) {
  const SceneFolder folder;
  folder.write("main.xml",
               "<scene version=\"3.0.0\"><shape type=\"obj\"><string name=\"filename\" value=\"gone.obj\"/><bsdf "
               "type=\"diffuse\"/></shape>"
               "<shape type=\"cube\"/></scene>");
  const Scene scene = load_scene(folder.path() / "main.xml");
  EXPECT_EQ(scene.source_files,
            (std::vector<std::filesystem::path>{folder.path() / "main.xml", folder.path() / "gone.obj"}));
  EXPECT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(mentions(scene.warnings, "its shape is left out"));
}

TEST(MitsubaValues, SpectraAndColours) {
  using namespace mitsuba;
  EXPECT_EQ(parse_color("0.1, 0.2 0.3"), Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(parse_color("0.5"), Rgb(0.5f));
  EXPECT_NEAR(parse_color("#ff8000")->y, 0.21586f, 1e-5f);  // ((128/255 + 0.055) / 1.055)^2.4
  EXPECT_FALSE(parse_color("1, 2"));
  EXPECT_FALSE(parse_color("#12345"));
  EXPECT_TRUE(parse_spectrum("2")->is_constant());
  EXPECT_EQ(parse_spectrum("400:1, 700:3")->spectrum.values, (std::vector<float>{1, 3}));
  EXPECT_FALSE(parse_spectrum("700:1 400:3"));
  EXPECT_FALSE(parse_spectrum("400:1"));
  EXPECT_EQ(parse_spd("# lamp\n400 1\n 500\t2 # peak\n\n")->spectrum.wavelengths_nm, (std::vector<float>{400, 500}));
  EXPECT_FALSE(parse_spd("400 1 2\n500 2\n"));
}

}  // namespace
}  // namespace relume
