// Executes the directives of pbrt files.
#pragma once

#include <filesystem>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "scene_io/pbrt/pbrt_description.h"
#include "scene_io/pbrt/pbrt_shapes.h"

namespace relume::pbrt {

/// Reads directives into a description, and the meshes of shapes into a scene.
class Directives {
 public:
  /// `base_dir`: folder of the scene file, in which included files must lie.
  Directives(std::filesystem::path base_dir, Description& description, Scene& scene, Warnings& warnings);

  /// Executes all directives of a file and of those that it includes. Throws Error.
  void run(const std::string& file, std::string_view text);
  /// Throws Error unless the world began and all blocks are closed. `file` names the scene.
  void finish(const std::string& file) const;

 private:
  using Defaults = std::shared_ptr<const DefaultList>;

  /// What AttributeBegin saves.
  struct State {
    TransformSet ctm;
    std::array<bool, 2> active{true, true};
    std::array<double, 2> times{0, 1};
    bool reversed = false;
    ColorSpace space = ColorSpace::srgb;
    Look look;
    std::array<Defaults, 5> defaults;  ///< of shape, light, material, medium, texture
  };

  struct Block {
    State saved;
    Location where;
    bool is_object = false;
  };

  void execute(Tokens& tokens, const Token& name);
  bool execute_block(Tokens& tokens, const Token& name);
  bool execute_transform(Tokens& tokens, const Token& name);
  bool execute_entity(Tokens& tokens, const Token& name);
  bool execute_setting(Tokens& tokens, const Token& name);

  void begin(const Location& where, bool is_object);
  void end(const Location& where, bool is_object);
  void world_begin();
  void begin_object(const std::string& name, const Location& where);
  void instance(const std::string& name, const Location& where);
  void set_defaults(Tokens& tokens);
  void activate(Tokens& tokens);
  void include(Tokens& tokens, const Token& directive);
  std::filesystem::path inside(const std::string& reference, const Location& where) const;

  /// Multiplies the active matrices by `matrix` from the right.
  void concatenate(const Matrix& matrix);
  void set(const Matrix& matrix);

  Parameters parameters(Tokens& tokens, const Location& where, int defaults = -1) const;
  void camera(Tokens& tokens, const Location& where);
  void texture(Tokens& tokens, const Location& where);
  void material(Tokens& tokens, const Location& where);
  void named_material(Tokens& tokens, const Location& where);
  void medium(Tokens& tokens, const Location& where);
  void medium_interface(Tokens& tokens);
  void shape(Tokens& tokens, const Location& where);

  std::filesystem::path base_dir_;
  Description& out_;
  Warnings& warnings_;
  ShapeReader shapes_;
  State state_;
  std::vector<Block> blocks_;
  std::map<std::string, TransformSet> systems_;
  std::list<std::string> names_;             ///< of all files, to which locations refer
  std::vector<std::filesystem::path> open_;  ///< files that are being read
  bool has_world_ = false;
  size_t files_read_ = 0;
  uint64_t bytes_read_ = 0;
  ObjectEntity* object_ = nullptr;  ///< that is being defined
  size_t copies_ = 0;               ///< shapes of all instances
};

}  // namespace relume::pbrt
