#include "scene_io/testing/example_files.h"

#include <draco/compression/config/compression_shared.h>

#include "scene_io/testing/compressed_files.h"
#include "scene_io/testing/figure_file.h"

namespace relume::testing {
namespace {

json rich_material(const json& texture) {
  const json moved = {
      {"index", 0},
      {"extensions", {{"KHR_texture_transform", {{"offset", {0.1, 0.2}}, {"rotation", 0.3}, {"scale", {4, 5}}}}}}};
  return {
      {"name", "paint"},
      {"pbrMetallicRoughness",
       {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"baseColorTexture", moved}, {"metallicRoughnessTexture", texture}}},
      {"normalTexture", texture},
      {"emissiveFactor", {1, 1, 1}},
      {"alphaMode", "MASK"},
      {"extensions",
       {{"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}},
        {"KHR_materials_transmission", {{"transmissionFactor", 0.5}, {"transmissionTexture", texture}}},
        {"KHR_materials_volume",
         {{"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {0.5, 0.5, 1}}}},
        {"KHR_materials_ior", {{"ior", 1.4}}},
        {"KHR_materials_dispersion", {{"dispersion", 0.4}}},
        {"KHR_materials_specular", {{"specularFactor", 0.5}}},
        {"KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatNormalTexture", texture}}},
        {"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}, {"anisotropyTexture", texture}}},
        {"KHR_materials_sheen", {{"sheenColorFactor", {1, 0.5, 0.2}}, {"sheenRoughnessFactor", 0.5}}},
        {"KHR_materials_iridescence", {{"iridescenceFactor", 1}, {"iridescenceThicknessTexture", texture}}},
        {"KHR_materials_diffuse_transmission", {{"diffuseTransmissionFactor", 0.5}}}}}};
}

json old_material(const json& texture) {
  return {{"extensions",
           {{"KHR_materials_pbrSpecularGlossiness",
             {{"diffuseFactor", {0.5, 0.5, 0.5, 1}}, {"specularGlossinessTexture", texture}}}}}};
}

int rich_mesh(GltfBuilder& file) {
  const int positions = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 3);
  const int patch_at = file.view(std::vector<uint16_t>{1, 3});
  const int patch = file.view(std::vector<float>{1, 0, 1, 1, 1, 1});
  file.doc["accessors"][static_cast<size_t>(positions)]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", patch_at}, {"componentType", 5123}}},
      {"values", {{"bufferView", patch}}}};
  const json attributes = {
      {"POSITION", positions},
      {"NORMAL",
       file.accessor(std::vector<int8_t>{0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0}, 4, 5120, true)},
      {"TEXCOORD_0", file.accessor(std::vector<uint16_t>{0, 0, 65535, 0, 0, 65535, 65535, 65535}, 2, 5123, true)},
      {"COLOR_0", file.accessor(std::vector<uint8_t>(16, 200), 4, 5121, true)}};
  json& normals = file.doc["accessors"][attributes["NORMAL"].get<size_t>()];
  normals["type"] = "VEC3";
  file.doc["bufferViews"][normals["bufferView"].get<size_t>()]["byteStride"] = 4;
  const int indices = file.accessor(std::vector<uint16_t>{0, 1, 2, 3}, 1, 5123);
  const json mappings = {{{"material", 0}, {"variants", {0}}}, {{"material", 1}, {"variants", {1}}}};
  const json variants = {{"KHR_materials_variants", {{"mappings", mappings}}}};
  return file.add(
      "meshes",
      {{"primitives",
        {{{"attributes", attributes}, {"indices", indices}, {"mode", 5}, {"material", 0}, {"extensions", variants}}}}});
}

GltfBuilder rich_gltf() {
  GltfBuilder file;
  file.add("images", {{"bufferView", file.add_view(solid_png(2, 2, 10, 20, 30, 255))}, {"mimeType", "image/png"}});
  file.add("samplers", {{"wrapS", 33071}});
  file.add("textures", {{"source", 0}, {"sampler", 0}});
  file.add("materials", rich_material({{"index", 0}}));
  file.add("materials", old_material({{"index", 0}}));
  file.doc["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "new"}}, {{"name", "old"}}};
  const int mesh = rich_mesh(file);
  file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  file.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"intensity", 40}, {"spot", {{"outerConeAngle", 0.2}}}}};
  const json instances = {{"TRANSLATION", file.floats({1, 2, 3, 4, 5, 6}, 3)}};
  const int child = file.add("nodes", {{"mesh", mesh}, {"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1}}});
  const int part = file.add_root({{"name", "part"},
                                  {"mesh", mesh},
                                  {"children", {child}},
                                  {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", instances}}}}}});
  file.add_root({{"camera", 0}, {"translation", {0, 0, 5}}});
  file.add_root({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const int times = file.floats({0, 1}, 1);
  const int turns = file.floats({0, 0, 0, 1, 0, 1, 0, 0}, 4);
  file.add("animations", {{"samplers", {{{"input", times}, {"output", turns}}}},
                          {"channels", {{{"sampler", 0}, {"target", {{"node", part}, {"path", "rotation"}}}}}}});
  return file;
}

std::string obj_text() {
  return "mtllib a.mtl\nusemtl m\no one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
         "f 1/1/1 2/2/1 3/3/1 4/4/1\ng two\ns off\nf -4//1 -3//1 -2//1\nl 1 2 3\np 1\nf 1 2 3\n";
}

std::string ply_header(const char* format) {
  return std::string("ply\nformat ") + format +
         " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
         "property uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int "
         "vertex_indices\nend_header\n";
}

template <typename T>
void append(Bytes& bytes, T value) {
  const size_t end = bytes.size();
  bytes.resize(end + sizeof(T));
  std::memcpy(&bytes[end], &value, sizeof(T));
}

Bytes binary_ply() {
  Bytes bytes = to_bytes(ply_header("binary_little_endian"));
  for (int i = 0; i < 3; ++i) {
    for (int c = 0; c < 3; ++c) append(bytes, i == c + 1 ? 1.0f : 0.0f);
    for (int c = 0; c < 3; ++c) append(bytes, static_cast<uint8_t>(i == c ? 255 : 0));
  }
  append(bytes, uint8_t{3});
  for (int32_t i = 0; i < 3; ++i) append(bytes, i);
  return bytes;
}

Bytes binary_stl() {
  Bytes bytes(80, std::byte{'x'});
  append(bytes, uint32_t{2});
  for (int triangle = 0; triangle < 2; ++triangle) {
    for (const float value : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) append(bytes, value);
    append(bytes, uint16_t{0});
  }
  return bytes;
}

/// 3DS chunk: number, length including this header, content.
Bytes chunk_3ds(uint16_t number, std::initializer_list<Bytes> parts) {
  constexpr size_t kHead = 6;
  Bytes content;
  for (const Bytes& part : parts) content.insert(content.end(), part.begin(), part.end());
  Bytes bytes;
  append(bytes, number);
  append(bytes, static_cast<uint32_t>(kHead + content.size()));
  bytes.insert(bytes.end(), content.begin(), content.end());
  return bytes;
}

Bytes file_3ds() {
  Bytes positions;
  append(positions, uint16_t{3});
  for (const float value : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) append(positions, value);
  Bytes faces;
  for (const uint16_t value : {1, 0, 1, 2, 0}) append(faces, value);  // count, vertices, flags
  const Bytes mesh = chunk_3ds(0x4100, {chunk_3ds(0x4110, {positions}), chunk_3ds(0x4120, {faces})});
  const Bytes object = chunk_3ds(0x4000, {Bytes{std::byte{'m'}, std::byte{0}}, mesh});
  return chunk_3ds(0x4d4d, {chunk_3ds(0x3d3d, {object})});
}

std::string relume_json_text() {
  return R"({"scene": "rich.gltf", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0], "fov_y_deg": 40, "lens_radius": 0.1, "focus_distance": 4},
"camera_keys": [{"time": 0, "eye": [0, 0, 5], "target": [0, 0, 0]}, {"time": 1, "eye": [5, 0, 0], "target": [0, 0, 0]}],
"lights": [{"type": "spot", "position": [0, 3, 0], "direction": [0, -1, 0], "intensity": [10, 9, 8], "outer_cone_deg": 30}],
"environment": {"sun_sky": {"elevation_deg": 30, "azimuth_deg": 90, "turbidity": 3}, "rotation_deg": 10},
"materials": {"paint": {"roughness": 0.5, "base_color": [0.5, 0.5, 0.5]}},
"nodes": {"part": {"keys": [{"time": 0, "rotation_deg": [0, 0, 0]}, {"time": 2, "rotation_deg": [0, 360, 0]}]}},
"settings": {"max-bounces": 4}})";
}

std::string mitsuba_text() {
  return R"(<?xml version="1.0"?>
<scene version="3.0.0">
<default name="size" value="8"/><path value="."/>
<integrator type="path"><integer name="max_depth" value="5"/></integrator>
<sensor type="thinlens" id="eye"><float name="fov" value="60"/><string name="fov_axis" value="smaller"/><float name="aperture_radius" value="0.1"/>
<transform name="to_world"><lookat origin="0, 1, 6" target="0, 0, 0" up="0, 1, 0"/></transform>
<film type="hdrfilm"><integer name="width" value="$size"/><integer name="height" value="$size"/><integer name="crop_width" value="4"/><integer name="crop_offset_x" value="2"/></film>
<sampler type="independent"><integer name="sample_count" value="2"/></sampler></sensor>
<bsdf type="twosided" id="paint"><bsdf type="principled"><rgb name="base_color" value="0.8 0.4 0.1"/><float name="roughness" value="0.4"/><float name="spec_trans" value="0.2"/><float name="clearcoat" value="1"/><float name="sheen" value="0.5"/></bsdf></bsdf>
<alias id="paint" as="coat"/>
<bsdf type="blendbsdf" id="blend"><float name="weight" value="0.3"/><bsdf type="roughconductor"><string name="material" value="Au"/><float name="alpha_u" value="0.1"/><float name="alpha_v" value="0.3"/></bsdf><bsdf type="roughplastic"><rgb name="diffuse_reflectance" value="#204080"/></bsdf></bsdf>
<bsdf type="mask" id="mask"><texture type="checkerboard" name="opacity"><transform name="to_uv"><scale x="2" y="3"/><rotate z="1" angle="20"/></transform></texture><bsdf type="dielectric"><string name="int_ior" value="water"/></bsdf></bsdf>
<bsdf type="bumpmap" id="bump"><texture type="bitmap"><string name="filename" value="a.png"/><boolean name="raw" value="true"/></texture><ref id="paint"/></bsdf>
<shape type="sphere"><point name="center" x="1" y="0" z="0"/><float name="radius" value="0.7"/><ref id="coat"/></shape>
<shape type="cylinder"><point name="p1" value="0, 1, 0"/><float name="radius" value="0.2"/><ref id="blend"/></shape>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="4"/><translate y="-1"/></transform><ref id="bump"/></shape>
<shape type="disk"><transform name="to_world"><matrix value="1 0 0 0 0 1 0 0 0 0 1 -1 0 0 0 1"/></transform><ref id="mask"/></shape>
<shape type="obj"><string name="filename" value="a.obj"/><boolean name="flip_normals" value="true"/></shape>
<shape type="shapegroup" id="group"><shape type="ply"><string name="filename" value="ascii.ply"/><boolean name="face_normals" value="true"/></shape></shape>
<shape type="instance"><ref id="group"/><transform name="to_world"><translate x="-2"/></transform></shape>
<shape type="cube"><transform name="to_world"><scale value="0.2"/><translate y="3"/></transform><emitter type="area"><spectrum name="radiance" value="400:2, 500:3, 700:5"/></emitter></shape>
<emitter type="spot"><float name="cutoff_angle" value="30"/><spectrum type="blackbody" name="intensity"><float name="temperature" value="3000"/><float name="scale" value="0.001"/></spectrum></emitter>
<emitter type="directional"><vector name="direction" x="0" y="-1" z="0.2"/></emitter>
<emitter type="sunsky"><float name="turbidity" value="3"/><integer name="month" value="6"/><float name="hour" value="11"/></emitter>
</scene>
)";
}

Figure moving_figure() {
  Figure figure;
  figure.animate(1, "rotation", {0, 1}, {0, 0, 0, 1, 0, 1, 0, 0}, 4, "turn");
  figure.animate(figure.node, "weights", {0, 1}, {0, 0, 0, 0, 8, 0, 0, -4, 1, 2, 0, 0}, 1, "grow", "CUBICSPLINE");
  return figure;
}

}  // namespace

std::string fbx_text(int up_axis) {
  const std::string up = std::to_string(up_axis);
  const std::string front = up_axis == 2 ? "1" : "2";
  const std::string sign = up_axis == 2 ? "-1" : "1";
  return "; FBX 7.4.0 project file\nFBXHeaderExtension: {\n FBXHeaderVersion: 1003\n FBXVersion: 7400\n}\n"
         "GlobalSettings: {\n Version: 1000\n Properties70: {\n"
         "  P: \"UpAxis\", \"int\", \"Integer\", \"\"," +
         up +
         "\n  P: \"UpAxisSign\", \"int\", \"Integer\", \"\",1\n"
         "  P: \"FrontAxis\", \"int\", \"Integer\", \"\"," +
         front + "\n  P: \"FrontAxisSign\", \"int\", \"Integer\", \"\"," + sign +
         "\n"
         "  P: \"CoordAxis\", \"int\", \"Integer\", \"\",0\n  P: \"CoordAxisSign\", \"int\", \"Integer\", \"\",1\n"
         "  P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",1\n }\n}\n"
         "Objects: {\n Geometry: 1, \"Geometry::g\", \"Mesh\" {\n  Vertices: *9 {\n   a: 0,0,100,100,0,100,0,100,100\n "
         " }\n"
         "  PolygonVertexIndex: *3 {\n   a: 0,1,-3\n  }\n  GeometryVersion: 124\n }\n"
         " Model: 2, \"Model::m\", \"Mesh\" {\n  Version: 232\n }\n}\n"
         "Connections: {\n C: \"OO\",2,0\n C: \"OO\",1,2\n}\n";
}

std::string dae_text() {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_cameras><camera id="c" name="cam"><optics><technique_common><perspective><yfov>40</yfov><aspect_ratio>2</aspect_ratio><znear>1</znear><zfar>100</zfar></perspective></technique_common></optics></camera></library_cameras>
<library_lights><light id="l" name="lamp"><technique_common><point><color>2 3 4</color></point></technique_common></light></library_lights>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 100 100 0 100 0 100 100</float_array><technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node>
<node id="cn" name="cn"><instance_camera url="#c"/></node><node id="ln" name="ln"><instance_light url="#l"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

/// Refers to ascii.ply.
std::string pbrt_text() {
  return R"(Film "rgb" "integer xresolution" 32 "integer yresolution" 24 "float iso" 200 # comment
Scale -1 1 1 LookAt 0 -4 1.5  0 0 0.5  0 0 1
Camera "perspective" "float fov" 50 "float lensradius" 0.01 "float focaldistance" 4
Sampler "zsobol" "integer pixelsamples" 4
Integrator "volpath" "integer maxdepth" 4
WorldBegin
Attribute "shape" "float alpha" 0.9
MakeNamedMedium "tea" "string type" "homogeneous" "rgb sigma_a" [1 2 3] "rgb sigma_s" [0 0 0]
Texture "squares" "spectrum" "checkerboard" "float uscale" 4 "float vscale" 4 "rgb tex1" [.8 .7 .6] "rgb tex2" [.1 .2 .3]
Texture "half" "spectrum" "scale" "texture tex" "squares" "float scale" 0.5
Texture "rough" "float" "mix" "float tex1" 0.1 "float tex2" 0.4 "float amount" 0.5
MakeNamedMaterial "paint" "string type" "coateddiffuse" "texture reflectance" "half" "texture roughness" "rough"
MakeNamedMaterial "gold" "string type" "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k" "float uroughness" 0.1 "float vroughness" 0.3
MakeNamedMaterial "both" "string type" "mix" "string materials" ["paint" "gold"] "float amount" 0.25
LightSource "infinite" "blackbody L" 6500 "float scale" 0.5
LightSource "spot" "spectrum I" [400 1 700 2] "point3 from" [0 0 3] "point3 to" [0 0 0] "float coneangle" 40
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [5 4 3] "bool twosided" true
  Translate 1 0 2 Rotate 90 1 0 0
  Shape "disk" "float radius" 0.5 "float innerradius" 0.1
AttributeEnd
AttributeBegin
  NamedMaterial "both"
  ActiveTransform EndTime Translate 0 0 0.5 ActiveTransform All
  Shape "sphere" "float radius" 0.4 "float zmax" 0.3 "float phimax" 300
AttributeEnd
AttributeBegin
  MediumInterface "tea" ""
  Material "dielectric" "spectrum eta" "glass-BK7"
  Translate -1 0 0
  Shape "cylinder" "float radius" 0.3 "float zmin" 0 "float zmax" 1
AttributeEnd
ObjectBegin "part"
  NamedMaterial "paint"
  Shape "plymesh" "string filename" "ascii.ply"
  Shape "bilinearmesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 1] "integer indices" [0 1 2 3] "point2 uv" [0 0 1 0 0 1 1 1]
ObjectEnd
Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 1 0 1]
ObjectInstance "part"
ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 1]
ReverseOrientation
ObjectInstance "part"
Shape "loopsubdiv" "integer levels" 2 "point3 P" [0 0 0 1 0 0 0 1 0 0 0 1] "integer indices" [0 2 1 0 1 3 1 2 3 2 0 3]
Shape "trianglemesh" "point3 P" [-2 -2 0 2 -2 0 0 2 0] "normal N" [0 0 1 0 0 1 0 0 1] "integer indices" [0 1 2]
)";
}

std::vector<ExampleFile> example_files() {
  const GltfBuilder rich = rich_gltf();
  return {{"rich.gltf", to_bytes(rich.text())},
          {"rich.glb", rich.glb()},
          {"meshopt.gltf", to_bytes(text_with_fallback(meshopt_quad()))},
          {"sequential.glb", draco_file(draco_quad(draco::MESH_SEQUENTIAL_ENCODING)).glb()},
          {"edgebreaker.glb", draco_file(draco_quad(draco::MESH_EDGEBREAKER_ENCODING)).glb()},
          {"a.obj", to_bytes(obj_text())},
          {"ascii.ply", to_bytes(ply_header("ascii") + "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n")},
          {"binary.ply", binary_ply()},
          {"binary.stl", binary_stl()},
          {"a.3ds", file_3ds()},
          {"a.off", to_bytes("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")},
          {"a.dae", to_bytes(dae_text())},
          {"a.fbx", to_bytes(fbx_text(2))},
          {"a.json", to_bytes(relume_json_text())},
          {"rich.pbrt", to_bytes(pbrt_text())},
          {"a.xml", to_bytes(mitsuba_text())},
          {"figure.gltf", to_bytes(moving_figure().file.text())},
          {"figure.glb", moving_figure().file.glb()}};
}

}  // namespace relume::testing
