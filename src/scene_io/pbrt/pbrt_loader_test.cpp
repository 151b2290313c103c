// Geometry, transforms, cameras and files.
#include "scene_io/pbrt/pbrt_loader.h"

#include <cmath>

#include <gtest/gtest.h>
#include <zlib.h>
#include <nlohmann/json.hpp>

#include "relume/scene_io.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::error_of;
using testing::mentions;
using testing::SceneFolder;
using testing::to_bytes;

Scene load(const std::string& text) { return load_pbrt_from_memory(to_bytes(text), "/nonexistent", "a.pbrt"); }
std::string error(const std::string& text) {
  return error_of([&] { load(text); });
}

const std::string kTriangle = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n";

/// World position of a vertex of the first mesh.
Vec3 placed(const Scene& scene, size_t vertex) {
  const std::vector<Mat4> world = world_matrices(scene, 0);
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (scene.nodes[i].meshes == std::vector<Index>{0})
      return Vec3(world[i] * Vec4(scene.meshes[0].positions[vertex], 1));
  }
  return Vec3(NAN);
}

/// Position in relume's image, from (-1, -1) to (1, 1) with y upwards.
Vec2 in_image(const Scene& scene, const Vec3& p) {
  const std::vector<Mat4> world = world_matrices(scene, 0);
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (scene.nodes[i].camera == kNone) continue;
    const Camera& camera = scene.cameras[0];
    EXPECT_GT(glm::determinant(Mat3(world[i])), 0);
    const Vec3 local(glm::inverse(world[i]) * Vec4(p, 1));
    const float height = std::tan(camera.fov_y_rad / 2);
    return Vec2(local.x / (height * camera.aspect_ratio), local.y / height) / -local.z;
  }
  return Vec2(NAN);
}

/// Position in pbrt's image by its definition: +x right, +y up, +z ahead. The field of view is that of the lower side.
Vec2 in_pbrt_image(const glm::dvec3& p, float fov_deg, float aspect) {
  const double half = std::tan(static_cast<double>(fov_deg) * M_PI / 360);
  return {p.x / p.z / half / (aspect > 1 ? aspect : 1), p.y / p.z / half * (aspect < 1 ? aspect : 1)};
}

TEST(Pbrt, ImagesAreNotMirrored) {
  // The camera matrix in pbrt's order of columns, by hand: looks along +y with +z up from (1, -5, 2). pbrt's LookAt has
  // right = up × ahead = -x.
  const std::string point = "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0.3 0.5 2.2 1 0 0 0 1 0]\n";
  const auto camera = [&](const std::string& transform, const std::string& film = "320\" 240") {
    return load("Film \"rgb\" \"integer xresolution\" 320 \"integer yresolution\" " + film + "\n" + transform +
                "\nCamera \"perspective\" \"float fov\" 50\n" + point);
  };
  const glm::dvec3 relative(-0.7, 5.5, 0.2);
  const struct {
    const char* transform;
    glm::dvec3 in_camera;
  } cases[] = {
      {"LookAt 1 -5 2  1 0 2  0 0 1", {-relative.x, relative.z, relative.y}},
      {"Scale -1 1 1 LookAt 1 -5 2  1 0 2  0 0 1", {relative.x, relative.z, relative.y}},
      {"Rotate 90 0 0 1 LookAt 1 -5 2  1 0 2  0 0 1", {-relative.z, -relative.x, relative.y}},
      {"Transform [1 0 0 0  0 0 1 0  0 1 0 0  -1 -2 5 1]", {relative.x, relative.z, relative.y}},
  };
  for (const auto& c : cases) {
    for (const int height : {200, 640}) {
      const Scene scene = camera(c.transform, std::to_string(height));
      const Vec2 expected = in_pbrt_image(c.in_camera, 50, 320.0f / static_cast<float>(height));
      const Vec2 found = in_image(scene, placed(scene, 0));
      EXPECT_NEAR(found.x, expected.x, 1e-4) << c.transform;
      EXPECT_NEAR(found.y, expected.y, 1e-4) << c.transform;
    }
  }
}

TEST(Pbrt, TurnsUpToPlusY) {
  const Scene scene = load("LookAt 0 -5 1 0 0 1 0 0 1 Camera \"perspective\"\nWorldBegin\n" + kTriangle);
  EXPECT_NEAR(placed(scene, 2).y, 0, 1e-6);
  const Scene above =
      load("LookAt 0 -5 1 0 0 1 0 0 1 Camera \"perspective\"\nWorldBegin\nTranslate 0 0 7 " + kTriangle);
  EXPECT_NEAR(placed(above, 0).y, 7, 1e-5);
}

TEST(Pbrt, FacesFollowNormalsAndOrientation) {
  // A mesh whose normals oppose its winding, and ReverseOrientation.
  const std::string normals = "\"normal N\" [0 0 -1 0 0 -1 0 0 -1]";
  const auto front = [](const Scene& scene) {
    const Mesh& m = scene.meshes[0];
    const UVec3 t = m.triangles[0];
    return glm::cross(m.positions[t.y] - m.positions[t.x], m.positions[t.z] - m.positions[t.x]).z;
  };
  const std::string shape = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] ";
  EXPECT_GT(front(load("WorldBegin " + shape)), 0);
  EXPECT_LT(front(load("WorldBegin " + shape + normals)), 0);
  EXPECT_LT(front(load("WorldBegin ReverseOrientation " + shape)), 0);
  EXPECT_GT(front(load("WorldBegin ReverseOrientation " + shape + normals)), 0);
  EXPECT_EQ(load("WorldBegin ReverseOrientation " + shape + normals).meshes[0].normals[0], Vec3(0, 0, 1));
}

TEST(Pbrt, TrianglesHaveDefaultCoordinates) {
  const Mesh mesh =
      load(
          "WorldBegin Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [0 0 0 1 0 0 1 1 "
          "0 0 1 0]\n")
          .meshes.at(0);
  ASSERT_EQ(mesh.uv0.size(), 6u);
  for (const UVec3& t : mesh.triangles) {
    EXPECT_EQ(mesh.uv0[t.x], Vec2(0, 1));
    EXPECT_EQ(mesh.uv0[t.y], Vec2(1, 1));
    EXPECT_EQ(mesh.uv0[t.z], Vec2(1, 0));
  }
}

TEST(Pbrt, TransformsNestAndRestore) {
  const Scene scene =
      load("WorldBegin\nTranslate 1 0 0\nCoordinateSystem \"here\"\nAttributeBegin\nScale 2 2 2 Rotate 90 0 0 1\n" +
           kTriangle +
           "AttributeEnd\nTransformBegin Identity CoordSysTransform \"here\" ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 "
           "0 5 0 1]\n"
           "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\nTransformEnd\n");
  const std::vector<Mat4> world = world_matrices(scene, 0);
  const Mat4 root = glm::inverse(world[0]);  // of pbrt's world
  const Vec4 first = root * world[1] * Vec4(1, 0, 0, 1);
  EXPECT_NEAR(glm::distance(Vec3(first), Vec3(1, 2, 0)), 0, 1e-5);
  const Vec4 second = root * world[2] * Vec4(0, 0, 0, 1);
  EXPECT_NEAR(glm::distance(Vec3(second), Vec3(1, 5, 0)), 0, 1e-5);
}

TEST(Pbrt, ObjectsAreInstanced) {
  const Scene scene = load("WorldBegin\nObjectBegin \"a\"\nTranslate 0 0 1 " + kTriangle + kTriangle +
                           "ObjectEnd\nAttributeBegin Translate 3 0 0 ObjectInstance \"a\" AttributeEnd\n"
                           "Scale -1 1 1 ObjectInstance \"a\"\n");
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].positions[0], Vec3(0, 0, 1));
  ASSERT_EQ(scene.nodes.size(), 3u);
  EXPECT_EQ(scene.nodes[1].meshes.size(), 2u);
  ASSERT_EQ(scene.nodes[1].instances.size(), 2u);
  EXPECT_EQ(Vec3(scene.nodes[1].instances[0][3]), Vec3(3, 0, 0));
  EXPECT_EQ(placed_triangles(scene), 4u);
}

TEST(Pbrt, EqualQuadricsShareAMesh) {
  const std::string sphere = "Translate 1 0 0 Shape \"sphere\" \"float radius\" 2\n";
  EXPECT_EQ(load("WorldBegin " + sphere + sphere).meshes.size(), 1u);
  const Scene similar = load("WorldBegin " + sphere + "Shape \"sphere\" \"float radius\" 3\n");
  ASSERT_EQ(similar.meshes.size(), 1u);
  EXPECT_NEAR(glm::length(Vec3(world_matrices(similar, 0)[1][0])), 2, 1e-6);
  EXPECT_NEAR(glm::length(Vec3(world_matrices(similar, 0)[2][0])), 3, 1e-6);
  EXPECT_EQ(load("WorldBegin " + sphere + "Material \"dielectric\" " + sphere).meshes.size(), 2u);
}

TEST(Pbrt, MotionBecomesKeyFrames) {
  const Scene scene =
      load("TransformTimes 1 3\nWorldBegin\nActiveTransform EndTime Translate 4 0 0 ActiveTransform All\n" + kTriangle);
  EXPECT_EQ(animation_end(scene), 3);
  EXPECT_EQ(world_matrices(scene, 2)[1][3].x, 2);
  EXPECT_TRUE(mentions(scene.notes, "relume animates what moves"));
  const auto settings = nlohmann::json::parse(scene.settings_json);
  EXPECT_EQ(settings["shutter"], 1.0f);
  EXPECT_EQ(settings["scene-time"], 0.5f);
}

TEST(Pbrt, TheShutterBecomesSettings) {
  const std::string moving = "WorldBegin\nActiveTransform EndTime Translate 4 0 0 ActiveTransform All\n" + kTriangle;
  const std::string camera = "Camera \"perspective\" \"float shutteropen\" 0.25 \"float shutterclose\" 0.75\n";
  const auto settings = nlohmann::json::parse(load("TransformTimes 0 1\n" + camera + moving).settings_json);
  EXPECT_EQ(settings["shutter"], 0.5f);
  EXPECT_EQ(settings["scene-time"], 0.5f);
  EXPECT_FALSE(nlohmann::json::parse(load(camera + "WorldBegin\n" + kTriangle).settings_json).contains("shutter"));
}

TEST(Pbrt, FilmAndIntegratorGiveSettings) {
  const Scene scene = load(
      "Film \"rgb\" \"integer xresolution\" 300 \"integer yresolution\" 200 \"float iso\" 400\n"
      "Sampler \"halton\" \"integer pixelsamples\" 7\nIntegrator \"path\" \"integer maxdepth\" 3\n"
      "Camera \"orthographic\" \"float screenwindow\" [-3 3 -2 2]\nWorldBegin\n");
  const auto settings = nlohmann::json::parse(scene.settings_json);
  EXPECT_EQ(settings,
            (nlohmann::json{{"width", 300}, {"height", 200}, {"max-bounces", 3}, {"spp", 7}, {"exposure", 2.0}}));
  EXPECT_EQ(scene.cameras[0].projection, Projection::orthographic);
  EXPECT_EQ(scene.cameras[0].half_height, 2);
}

TEST(Pbrt, IncludesFilesOfItsFolder) {
  const SceneFolder folder;
  folder.write("part.pbrt", "Translate 0 0 1\n" + kTriangle);
  const auto main = folder.write("main.pbrt", "WorldBegin\nImport \"part.pbrt\"\nInclude \"part.pbrt\"\n" + kTriangle);
  const Scene scene = load_scene(main);
  ASSERT_EQ(scene.meshes.size(), 3u);
  const std::vector<Mat4> world = world_matrices(scene, 0);
  const auto height = [&](size_t i) { return (glm::inverse(world[0]) * world[i])[3].z; };
  EXPECT_EQ(height(1), 1);
  EXPECT_EQ(height(2), 1);  // the import did not move it
  EXPECT_EQ(height(3), 1);  // the inclusion did
  EXPECT_EQ(scene.source_files.size(), 2u);
}

TEST(Pbrt, BoundsInclusions) {
  const SceneFolder folder;
  const auto loop = folder.write("loop.pbrt", "Include \"other.pbrt\"\n");
  folder.write("other.pbrt", "\nInclude \"./loop.pbrt\"\n");
  EXPECT_NE(error_of([&] { load_scene(loop); }).find("other.pbrt:2: "), std::string::npos);
  EXPECT_NE(error_of([&] { load_scene(loop); }).find("includes itself"), std::string::npos);
  for (int i = 0; i < 40; ++i) {
    folder.write("b" + std::to_string(i) + ".pbrt",
                 "Include \"b" + std::to_string(i + 1) + ".pbrt\"\nInclude \"b" + std::to_string(i + 1) + ".pbrt\"\n");
  }
  EXPECT_NE(error_of([&] { load_scene(folder.path() / "b0.pbrt"); }).find("merge some"), std::string::npos);
  folder.write("b20.pbrt", "\n");
  EXPECT_NE(error_of([&] { load_scene(folder.path() / "b0.pbrt"); }).find("merge some"), std::string::npos);
  for (const char* outside : {"../a.pbrt", "/etc/passwd", "x/../../a.pbrt"})
    EXPECT_NE(error("Include \"" + std::string(outside) + "\"").find("outside the folder"), std::string::npos);
}

TEST(Pbrt, ReferencesStayInTheFolder) {
  const SceneFolder folder;
  folder.write("m.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement "
               "face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  std::filesystem::create_directory(folder.path() / "inner");
  const auto scene_with = [&](const std::string& reference) {
    return folder.write("inner/a.pbrt", "WorldBegin Shape \"plymesh\" \"string filename\" \"" + reference + "\"\n");
  };
  for (const std::string& outside : {std::string("../m.ply"), (folder.path() / "m.ply").string(),
                                     "file://" + (folder.path() / "m.ply").string(), std::string("..\\\\m.ply")})
    EXPECT_NE(error_of([&] { load_scene(scene_with(outside)); }).find("inner/a.pbrt:1: '"), std::string::npos);
  std::filesystem::copy_file(folder.path() / "m.ply", folder.path() / "inner" / "m.ply");
  EXPECT_EQ(load_scene(scene_with("../m.ply")).meshes.size(), 1u);  // by its name
}

Bytes gzip(const std::string& text) {
  z_stream stream = {};
  EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY), Z_OK);
  Bytes bytes(deflateBound(&stream, text.size()));
  std::string input = text;
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

TEST(Pbrt, ReadsCompressedFiles) {
  const SceneFolder folder;
  const Bytes mesh = gzip(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
      "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  folder.write("m.ply.gz", mesh);
  const Bytes scene = gzip("WorldBegin Shape \"plymesh\" \"string filename\" \"m.ply.gz\"\n");
  const Scene loaded = load_scene(folder.write("a.pbrt.gz", scene));
  EXPECT_EQ(loaded.meshes.at(0).positions.size(), 3u);
  EXPECT_TRUE(loaded.meshes[0].normals.empty());  // flat, as in pbrt
  const Bytes cut(scene.begin(), scene.end() - 10);
  EXPECT_NE(error_of([&] { load_scene(folder.write("b.pbrt.gz", cut)); }).find("data are damaged"), std::string::npos);
  const Bytes bomb = gzip(std::string(size_t{100} << 20, '\n'));
  EXPECT_NE(error_of([&] { load_scene(folder.write("c.pbrt.gz", bomb)); }).find("grows to more than"),
            std::string::npos);
}

TEST(Pbrt, LaterDefaultsComeFirst) {
  const std::string defaults =
      "WorldBegin Attribute \"shape\" \"float radius\" 2 Attribute \"shape\" \"float radius\" 3 ";
  const auto radius = [](const Scene& scene) { return glm::length(placed(scene, 100)); };
  EXPECT_NEAR(radius(load(defaults + "Shape \"sphere\"")), 3, 1e-5);
  EXPECT_NEAR(radius(load(defaults + "Shape \"sphere\" \"float radius\" 4")), 4, 1e-5);
}

TEST(Pbrt, BoundsNesting) {
  std::string deep = "WorldBegin\n";
  for (int i = 0; i < 100000; ++i) deep += "AttributeBegin\n";
  EXPECT_NE(error(deep).find("nested"), std::string::npos);
  std::string defaults = "WorldBegin\n";
  for (int i = 0; i < 100000; ++i) defaults += "Attribute \"shape\" \"float radius\" 2\n";
  EXPECT_NEAR(glm::length(placed(load(defaults + "Shape \"sphere\"\n"), 0)), 2, 1e-5);
  for (int i = 0; i < 100; ++i) defaults += "Attribute \"shape\" \"float radius" + std::to_string(i) + "\" 2\n";
  EXPECT_NE(error(defaults).find("more than 64 parameters have defaults"), std::string::npos);
  std::string copies = "WorldBegin\nObjectBegin \"a\"\n";
  for (int i = 0; i < 4000; ++i) copies += kTriangle;
  copies += "ObjectEnd\n";
  for (int i = 0; i < 4000; ++i) copies += "ObjectInstance \"a\"\n";
  EXPECT_NE(error(copies).find("merge the shapes"), std::string::npos);
}

TEST(Pbrt, BoundsTessellation) {
  const Scene scene = load(
      "WorldBegin\nShape \"loopsubdiv\" \"integer levels\" 1000000 \"integer indices\" [0 1 2] \"point3 P\" [0 0 0 1 0 "
      "0 "
      "0 1 0]\n");
  EXPECT_LE(scene.meshes.at(0).triangles.size(), size_t{1} << 20);
  EXPECT_TRUE(mentions(scene.warnings, "fewer than 1000000 levels"));
  std::string spheres = "WorldBegin\n";
  for (int i = 0; i < 50000; ++i) spheres += "Material \"diffuse\" Shape \"sphere\"\n";
  EXPECT_NE(error(spheres).find("give them the same material"), std::string::npos);
}

TEST(Pbrt, NumbersBeyondTheRangeOfDouble) {
  EXPECT_EQ(
      placed(load("LookAt 0 0 0 0 0 1 0 1 0 Camera \"perspective\" WorldBegin Translate 1e-400 1 0 " + kTriangle), 0).y,
      1);
  EXPECT_NE(error("WorldBegin Translate 1e400 0 0 " + kTriangle).find("not finite"), std::string::npos);
}

TEST(Pbrt, ErrorsNameTheLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"WorldBegin\n\nShape \"trianglemesh\"", "a.pbrt:3: the shape has no vertices"},
      {"WorldBegin\nShape \"sphere\" \"float radius\" -1", "a.pbrt:2: 'radius' is -1"},
      {"WorldBegin\nShape \"torus\"", "a.pbrt:2: there is no shape 'torus'"},
      {"WorldBegin\nShape \"trianglemesh\" \"integer indices\" [0 1 9] \"point3 P\" [0 0 0 1 0 0 0 1 0]",
       "a.pbrt:2: index 9 is out of range"},
      {"Translate 1 x 2", "a.pbrt:1: 'x' is not a number"},
      {"Translate 1", "the file ends where a number is expected"},
      {"AttributeEnd", "a.pbrt:1: AttributeEnd has no beginning"},
      {"\nAttributeBegin", "a.pbrt:2: a block that begins here has no end"},
      {"Nonsense", "a.pbrt:1: 'Nonsense' is no directive"},
      {"# comment \"\nMaterial \"diffuse", "a.pbrt:2: a string has no end"},
      {"WorldBegin\nObjectInstance \"none\"", "a.pbrt:2: there is no object 'none'"},
      {"WorldBegin\nNamedMaterial \"none\"\nShape \"sphere\"", "a.pbrt:3: there is no material 'none'"},
      {"WorldBegin\nLightSource \"lamp\"", "a.pbrt:2: there is no light 'lamp'"},
      {"WorldBegin\nMaterial \"diffuse\" \"texture reflectance\" \"none\"\nShape \"sphere\"",
       "a.pbrt:2: there is no spectrum texture 'none'"},
      {"WorldBegin\nTexture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"t\"\nMaterial \"diffuse\" \"texture "
       "reflectance\" \"t\"\nShape \"sphere\"",
       "refers to itself"},
      {"WorldBegin\nInclude \"none.pbrt\"", "a.pbrt:2: /nonexistent/none.pbrt: the file does not exist"},
      {"WorldBegin\nShape \"plymesh\" \"string filename\" \"none.ply\"", "a.pbrt:2: /nonexistent/none.ply: "},
      {"WorldBegin\nMaterial \"conductor\"\n\"spectrum eta\" \"none.spd\" Shape \"sphere\"",
       "a.pbrt:3: /nonexistent/none.spd: "},
      {"Camera \"fisheye\"\nWorldBegin", "a.pbrt:1: there is no camera 'fisheye'"},
  };
  for (const auto& [text, expected] : cases) EXPECT_NE(error(text).find(expected), std::string::npos) << error(text);
  EXPECT_EQ(error("Include \"" + std::string(1 << 20, 'x') + "\""),
            "a.pbrt:1: a string has more than 4096 characters; shorten it");
  EXPECT_EQ(error(std::string("Include \"a\0b\"", 13)), "a.pbrt:1: a string contains a zero byte; remove it");
}

TEST(Pbrt, CropWindowsAreRequested) {
  const auto crop = [](const std::string& film) {
    return load("Film \"rgb\" \"integer xresolution\" 300 \"integer yresolution\" 200 " + film + "\nWorldBegin\n").crop;
  };
  EXPECT_EQ(crop("\"float cropwindow\" [0.75 0.25 0.1 0.5]"), (ImagePart{0.25f, 0.1f, 0.75f, 0.5f}));
  EXPECT_EQ(crop("\"float cropwindow\" [0.001 0.5 0 1]"), (ImagePart{1.0f / 300, 0, 0.5f, 1}));
  EXPECT_EQ(crop("\"integer pixelbounds\" [10 30 -5 999]"), (ImagePart{10.0f / 300, 0, 30.0f / 300, 1}));
  EXPECT_EQ(crop("\"float cropwindow\" [0 1 0 1]"), ImagePart{});
  EXPECT_EQ(crop("\"float cropwindow\" [nan 1 nan 1]"), ImagePart{});
}

TEST(Pbrt, WarnsOfWhatHasNoCounterpart) {
  const Scene scene = load(
      "Camera \"orthographic\" \"float lensradius\" 1\nWorldBegin\n"
      "ObjectBegin \"a\" ActiveTransform EndTime Translate 1 0 0 Shape \"sphere\" ObjectEnd ObjectInstance \"a\"\n"
      "AreaLightSource \"diffuse\" Shape \"sphere\" \"float alpha\" 0\n"
      "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb Le\" [1 1 1] MediumInterface \"m\" \"\"\n"
      "Material \"dielectric\" Shape \"sphere\"\nMaterial \"interface\" Shape \"sphere\"\n"
      "Material \"diffusetransmission\" \"rgb reflectance\" [0.9 0 0] \"rgb transmittance\" [0 0.9 0]\n"
      "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"string emissionfilename\" \"a.png\"\n");
  for (const char* part :
       {"an orthographic camera with a lens", "shapes that move in an object", "with alpha 0",
        "parameter 'rgb Le' of medium", "area lights with the material 'interface'", "sum to more than 1"})
    EXPECT_TRUE(mentions(scene.warnings, part)) << part;
  EXPECT_FALSE(mentions(scene.warnings, "emissionfilename"));  // changes only the noise
  EXPECT_EQ(scene.materials.size(), 4u);                       // none of the interface
}

TEST(Pbrt, WarnsOncePerKind) {
  const Scene scene =
      load("WorldBegin\nMaterial \"hair\"\nShape \"sphere\" \"float radiuss\" 3\nShape \"curve\"\nShape \"curve\"\n");
  EXPECT_TRUE(mentions(scene.warnings, "materials of type 'hair' are not supported"));
  EXPECT_TRUE(mentions(scene.warnings, "parameter 'float radiuss' of shape 'sphere' is ignored"));
  EXPECT_TRUE(mentions(scene.warnings, "curves are not supported"));
  EXPECT_EQ(scene.warnings.size(), 4u);  // and the missing camera
}

}  // namespace
}  // namespace relume
