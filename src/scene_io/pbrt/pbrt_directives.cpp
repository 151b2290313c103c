#include "scene_io/pbrt/pbrt_directives.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "files/bytes.h"
#include "relume/error.h"
#include "scene_io/pbrt/gzip.h"

namespace relume::pbrt {
namespace {

constexpr size_t kMaxDepth = 1024;       // nested blocks
constexpr size_t kMaxIncludeDepth = 32;  // files that include each other
constexpr size_t kMaxDefaults = 64;      // of one target of Attribute
constexpr size_t kMaxFiles = 4096;       // included files
constexpr uint64_t kMaxBytes = uint64_t{1} << 33;
constexpr size_t kMaxCopies = size_t{1} << 23;  // shapes of all instances

constexpr std::string_view kTargets[] = {"shape", "light", "material", "medium", "texture"};
constexpr int kShape = 0, kLight = 1, kMaterial = 2, kMedium = 3, kTexture = 4;

glm::dvec3 vector_of(Tokens& tokens) {
  const double x = tokens.require_number();
  const double y = tokens.require_number();
  return {x, y, tokens.require_number()};
}

Matrix matrix_of(Tokens& tokens) {
  const Token open = tokens.require("[");
  if (!open.is("[")) fail(open.where, "a matrix has 16 numbers in brackets; add them");
  Matrix matrix;
  for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = tokens.require_number();
  const Token close = tokens.require("]");
  if (!close.is("]")) fail(close.where, "a matrix has 16 numbers in brackets; remove the others");
  return matrix;
}

/// Text that differs for shapes of different looks.
std::string key_of(const Look& look) {
  return fmt::format("{} {} {} {} {} {}", static_cast<const void*>(look.material.get()), look.material_name,
                     static_cast<const void*>(look.area_light.get()), look.inside_medium, look.alpha_texture,
                     look.alpha);
}

}  // namespace

Directives::Directives(std::filesystem::path base_dir, Description& description, Scene& scene, Warnings& warnings)
    : base_dir_(std::move(base_dir)), out_(description), warnings_(warnings), shapes_(base_dir_, scene, warnings) {
  state_.look.material = std::make_shared<const MaterialEntity>(MaterialEntity{"", "diffuse", {}});
}

void Directives::run(const std::string& file, std::string_view text) {
  const std::string& name = names_.emplace_back(file);
  open_.push_back(std::filesystem::path(file).lexically_normal());
  Tokens tokens(name, text);
  while (const std::optional<Token> token = tokens.next()) execute(tokens, *token);
  open_.pop_back();
}

void Directives::finish(const std::string& file) const {
  if (!blocks_.empty())
    fail(blocks_.back().where, fmt::format("a block that begins here has no end in {}; add {}", file,
                                           blocks_.back().is_object ? "ObjectEnd" : "AttributeEnd"));
  if (!has_world_) throw Error(fmt::format("{}: there is no WorldBegin; the file is no scene, or cut off", file));
}

void Directives::execute(Tokens& tokens, const Token& name) {
  if (!name.quoted && (execute_transform(tokens, name) || execute_block(tokens, name) || execute_entity(tokens, name) ||
                       execute_setting(tokens, name)))
    return;
  fail(name.where, fmt::format("'{}' is no directive of pbrt-v4; remove it, or convert the scene with pbrt --upgrade",
                               name.text.substr(0, 40)));
}

bool Directives::execute_block(Tokens& tokens, const Token& name) {
  if (name.is("AttributeBegin") || name.is("TransformBegin")) {
    begin(name.where, false);
  } else if (name.is("AttributeEnd") || name.is("TransformEnd")) {
    end(name.where, false);
  } else if (name.is("WorldBegin")) {
    world_begin();
  } else if (name.is("WorldEnd")) {
    return true;
  } else if (name.is("ObjectBegin")) {
    begin_object(tokens.require_string("the name of an object"), name.where);
  } else if (name.is("ObjectEnd")) {
    end(name.where, true);
    object_ = nullptr;
  } else if (name.is("ObjectInstance")) {
    instance(tokens.require_string("the name of an object"), name.where);
  } else if (name.is("Attribute")) {
    set_defaults(tokens);
  } else if (name.is("Include") || name.is("Import")) {
    include(tokens, name);
  } else {
    return false;
  }
  return true;
}

bool Directives::execute_transform(Tokens& tokens, const Token& name) {
  if (name.is("Identity")) {
    set(Matrix(1));
  } else if (name.is("Translate")) {
    concatenate(glm::translate(Matrix(1), vector_of(tokens)));
  } else if (name.is("Scale")) {
    concatenate(glm::scale(Matrix(1), vector_of(tokens)));
  } else if (name.is("Rotate")) {
    const double degrees = tokens.require_number();
    concatenate(rotation_matrix(degrees, vector_of(tokens)));
  } else if (name.is("LookAt")) {
    const glm::dvec3 eye = vector_of(tokens);
    const glm::dvec3 target = vector_of(tokens);
    const glm::dvec3 up = vector_of(tokens);
    if (!out_.has_camera) out_.camera.up = up;
    concatenate(look_at_matrix(eye, target, up));
  } else if (name.is("Transform")) {
    set(matrix_of(tokens));
  } else if (name.is("ConcatTransform")) {
    concatenate(matrix_of(tokens));
  } else if (name.is("CoordinateSystem")) {
    systems_[tokens.require_string("the name of a coordinate system")] = state_.ctm;
  } else if (name.is("CoordSysTransform")) {
    const auto system = systems_.find(tokens.require_string("the name of a coordinate system"));
    if (system == systems_.end()) fail(name.where, "there is no coordinate system of that name; define it before");
    state_.ctm = system->second;
  } else if (name.is("ActiveTransform")) {
    activate(tokens);
  } else if (name.is("TransformTimes")) {
    state_.times[0] = tokens.require_number();
    state_.times[1] = tokens.require_number();
  } else if (name.is("ReverseOrientation")) {
    state_.reversed = !state_.reversed;
  } else {
    return false;
  }
  return true;
}

bool Directives::execute_entity(Tokens& tokens, const Token& name) {
  const Location& where = name.where;
  if (name.is("Shape")) {
    shape(tokens, where);
  } else if (name.is("Material")) {
    material(tokens, where);
  } else if (name.is("MakeNamedMaterial")) {
    named_material(tokens, where);
  } else if (name.is("NamedMaterial")) {
    state_.look.material_name = tokens.require_string("the name of a material");
  } else if (name.is("Texture")) {
    texture(tokens, where);
  } else if (name.is("LightSource")) {
    const std::string kind = tokens.require_string("the type of a light");
    out_.lights.push_back({kind, parameters(tokens, where, kLight), state_.ctm});
  } else if (name.is("AreaLightSource")) {
    const std::string kind = tokens.require_string("the type of a light");
    state_.look.area_light =
        std::make_shared<const AreaLightEntity>(AreaLightEntity{kind, parameters(tokens, where, kLight)});
  } else if (name.is("MakeNamedMedium")) {
    medium(tokens, where);
  } else if (name.is("MediumInterface")) {
    medium_interface(tokens);
  } else {
    return false;
  }
  return true;
}

bool Directives::execute_setting(Tokens& tokens, const Token& name) {
  if (name.is("Camera")) {
    camera(tokens, name.where);
  } else if (name.is("ColorSpace")) {
    const std::string space = tokens.require_string("the name of a colour space");
    const auto known = color_space_named(space);
    if (!known)
      fail(name.where, fmt::format("there is no colour space '{}'; use srgb, dci-p3, rec2020 or aces2065-1", space));
    state_.space = *known;
  } else if (name.is("Option")) {
    tokens.require_string("the name of an option");
    tokens.require("the value of an option");
  } else if (name.is("Film") || name.is("Sampler") || name.is("Integrator") || name.is("PixelFilter") ||
             name.is("Accelerator")) {
    tokens.require_string("a type");
    const Parameters given = parameters(tokens, name.where);
    out_.has_sampler |= name.is("Sampler");
    if (name.is("Film")) out_.film = given;
    if (name.is("Integrator")) out_.integrator = given;
    if (name.is("Sampler")) out_.sampler = given;
  } else {
    return false;
  }
  return true;
}

void Directives::begin(const Location& where, bool is_object) {
  if (blocks_.size() >= kMaxDepth)
    fail(where, fmt::format("more than {} blocks are nested; the file is damaged, export it again", kMaxDepth));
  blocks_.push_back({state_, where, is_object});
}

void Directives::end(const Location& where, bool is_object) {
  if (blocks_.empty() || blocks_.back().is_object != is_object)
    fail(where, fmt::format("{} has no beginning; remove it", is_object ? "ObjectEnd" : "AttributeEnd"));
  state_ = std::move(blocks_.back().saved);
  blocks_.pop_back();
}

void Directives::world_begin() {
  has_world_ = true;
  state_.ctm = {};
  state_.active = {true, true};
  systems_["world"] = state_.ctm;
}

void Directives::begin_object(const std::string& name, const Location& where) {
  if (object_) fail(where, "an object is defined inside another; move it outside");
  begin(where, true);
  const auto [entry, is_new] = out_.objects.try_emplace(name);
  if (!is_new) fail(where, fmt::format("there are two objects '{}'; rename one", name));
  object_ = &entry->second;
}

void Directives::instance(const std::string& name, const Location& where) {
  if (object_) fail(where, "an instance stands in the definition of an object; move it outside");
  const auto object = out_.objects.find(name);
  if (object == out_.objects.end()) fail(where, fmt::format("there is no object '{}'; define it before", name));
  copies_ += object->second.shapes.size();
  if (copies_ > kMaxCopies)
    fail(where, fmt::format("the instances have more than {} shapes; merge the shapes of objects", kMaxCopies));
  if (state_.ctm.is_animated()) {
    object->second.moving.emplace_back(state_.ctm, state_.times);
  } else {
    object->second.instances.push_back(narrow(state_.ctm.at[0]));
  }
}

void Directives::set_defaults(Tokens& tokens) {
  const Token target = tokens.require("a target");
  const auto at = std::find(std::begin(kTargets), std::end(kTargets), target.text);
  if (!target.quoted || at == std::end(kTargets))
    fail(target.where, fmt::format("'{}' is no target of Attribute; use \"shape\", \"light\", \"material\", \"medium\" "
                                   "or \"texture\"",
                                   target.text.substr(0, 40)));
  Defaults& defaults = state_.defaults[static_cast<size_t>(at - std::begin(kTargets))];
  DefaultList list;
  for (Parameter& parameter : parse_parameters(tokens, state_.space))
    list.push_back(std::make_shared<const Parameter>(std::move(parameter)));
  const auto is_hidden = [&](const auto& earlier) {
    return std::any_of(list.begin(), list.end(),
                       [&](const auto& later) { return later->name == earlier->name && later->type == earlier->type; });
  };
  DefaultList all = list;
  if (defaults) std::remove_copy_if(defaults->begin(), defaults->end(), std::back_inserter(all), is_hidden);
  if (all.size() > kMaxDefaults)
    fail(target.where, fmt::format("more than {} parameters have defaults; remove some", kMaxDefaults));
  defaults = std::make_shared<const DefaultList>(std::move(all));
}

void Directives::activate(Tokens& tokens) {
  const Token which = tokens.require("All, StartTime or EndTime");
  const bool all = which.is("All");
  state_.active = {all || which.is("StartTime"), all || which.is("EndTime")};
  if (!state_.active[0] && !state_.active[1])
    fail(which.where, "ActiveTransform is followed by All, StartTime or EndTime; correct it");
}

std::filesystem::path Directives::inside(const std::string& reference, const Location& where) const {
  const std::filesystem::path relative = std::filesystem::path(reference).lexically_normal();
  if (relative.empty() || relative.is_absolute() || *relative.begin() == "..")
    fail(where, fmt::format("the file '{}' lies outside the folder of the scene; move it inside", reference));
  return (base_dir_ / relative).lexically_normal();
}

void Directives::include(Tokens& tokens, const Token& directive) {
  const std::filesystem::path file = inside(tokens.require_string("the name of a file"), directive.where);
  if (std::find(open_.begin(), open_.end(), file) != open_.end())
    fail(directive.where, fmt::format("{} includes itself; remove the directive", file.string()));
  if (open_.size() >= kMaxIncludeDepth || ++files_read_ > kMaxFiles)
    fail(directive.where, fmt::format("more than {} files are nested, or more than {} included; merge some",
                                      kMaxIncludeDepth, kMaxFiles));
  const Bytes bytes = gunzipped(read_reference(file, directive.where), file.string());
  bytes_read_ += bytes.size();
  if (bytes_read_ > kMaxBytes) fail(directive.where, "the included files have more than 8 GiB; split the scene");
  const State saved = state_;
  const size_t depth = blocks_.size();
  run(file.string(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!directive.is("Import")) return;
  if (blocks_.size() != depth)
    fail(directive.where, fmt::format("{} leaves a block open; add AttributeEnd", file.string()));
  state_ = saved;
}

void Directives::concatenate(const Matrix& matrix) {
  for (size_t i = 0; i < 2; ++i) {
    if (state_.active[i]) state_.ctm.at[i] *= matrix;
  }
}

void Directives::set(const Matrix& matrix) {
  for (size_t i = 0; i < 2; ++i) {
    if (state_.active[i]) state_.ctm.at[i] = matrix;
  }
}

Parameters Directives::parameters(Tokens& tokens, const Location& where, int defaults) const {
  ParameterList list = parse_parameters(tokens, state_.space);
  return Parameters(where, std::move(list), defaults < 0 ? nullptr : state_.defaults[static_cast<size_t>(defaults)]);
}

void Directives::camera(Tokens& tokens, const Location& where) {
  out_.camera.kind = tokens.require_string("the type of a camera");
  out_.camera.parameters = parameters(tokens, where);
  out_.camera.from_world = state_.ctm;
  out_.camera.times = state_.times;
  out_.has_camera = true;
  for (size_t i = 0; i < 2; ++i) systems_["camera"].at[i] = inverse_or_identity(state_.ctm.at[i]);
}

void Directives::texture(Tokens& tokens, const Location& where) {
  const std::string name = tokens.require_string("the name of a texture");
  const std::string type = tokens.require_string("the type of a texture");
  const std::string kind = tokens.require_string("the kind of a texture");
  const bool is_float = type == "float";
  if (!is_float && type != "spectrum")
    fail(where, fmt::format("the texture '{}' is of type '{}'; use float or spectrum", name, type));
  auto& textures = is_float ? out_.float_textures : out_.color_textures;
  textures.insert_or_assign(name, TextureEntity{kind, is_float, parameters(tokens, where, kTexture)});
}

void Directives::material(Tokens& tokens, const Location& where) {
  const std::string kind = tokens.require_string("the type of a material");
  state_.look.material =
      std::make_shared<const MaterialEntity>(MaterialEntity{"", kind, parameters(tokens, where, kMaterial)});
  state_.look.material_name.clear();
}

void Directives::named_material(Tokens& tokens, const Location& where) {
  const std::string name = tokens.require_string("the name of a material");
  Parameters given = parameters(tokens, where, kMaterial);
  const std::string kind = given.string("type");
  if (kind.empty()) fail(where, fmt::format("the material '{}' has no type; give it 'string type'", name));
  out_.materials.insert_or_assign(name, std::make_shared<const MaterialEntity>(MaterialEntity{name, kind, given}));
}

void Directives::medium(Tokens& tokens, const Location& where) {
  const std::string name = tokens.require_string("the name of a medium");
  Parameters given = parameters(tokens, where, kMedium);
  const std::string kind = given.string("type");
  out_.media.insert_or_assign(name, MediumEntity{kind, std::move(given)});
}

void Directives::medium_interface(Tokens& tokens) {
  state_.look.inside_medium = tokens.require_string("the name of a medium");
  if (tokens.peek() && tokens.peek()->quoted) tokens.next();
}

void Directives::shape(Tokens& tokens, const Location& where) {
  const std::string kind = tokens.require_string("the type of a shape");
  const Parameters given = parameters(tokens, where, kShape);
  Look look = state_.look;
  look.where = where;
  if (const Parameter* p = given.find("alpha", {"texture"}); p && !p->strings.empty()) {
    look.alpha_texture = p->strings[0];
  } else {
    look.alpha = given.number("alpha", 1);
  }
  if (object_ && look.area_light) {
    warnings_.add("pbrt has no area lights in objects with instances; these shapes do not emit");
    look.area_light = nullptr;
  }
  if (object_ && state_.ctm.is_animated())
    warnings_.add("shapes that move in an object are not supported; they stay where they begin");
  const Mat4 to_object = narrow(state_.ctm.at[0]);
  if (!is_affine(state_.ctm.at[0]) || !is_affine(state_.ctm.at[1]))
    fail(where, "the transform of a shape is not affine or not finite; correct it");
  std::string key = key_of(look);
  const bool has_power = look.area_light && look.area_light->parameters.find("power", {"float"});
  if (has_power) key += fmt::format(" {}", out_.shapes.size());  // its radiance depends on the area
  ShapeEntity made = shapes_.read(kind, given, state_.reversed, object_ ? &to_object : nullptr, key);
  given.warn_of_unused(fmt::format("shape '{}'", kind), warnings_);
  if (made.mesh == kNone) return;
  made.look = std::move(look);
  made.to_world = state_.ctm;
  for (Matrix& matrix : made.to_world.at) matrix = glm::scale(matrix, glm::dvec3(made.scale));
  made.times = state_.times;
  (object_ ? object_->shapes : out_.shapes).push_back(std::move(made));
}

}  // namespace relume::pbrt
