#include "cli/file_roles.h"

#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "cli/command.h"
#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"

namespace relume::cli {
namespace {

namespace fs = std::filesystem;

std::string refusal_of(const std::function<void()>& task) {
  try {
    task();
  } catch (const UsageError& error) {
    return error.what();
  }
  return {};
}

class FileRolesTest : public ::testing::Test {
 protected:
  fs::path existing(const std::string& name) {
    write_file(folder_ / name, name);
    return folder_ / name;
  }
  /// The reason why `file` may not be written beside the files that have a role.
  std::string refused(const fs::path& file) {
    return refusal_of([&] { FileRoles(roles_).writes("--stats", file); });
  }

  const TempFolder folder_;
  FileRoles roles_;
};

TEST_F(FileRolesTest, NewFilesHaveOneRoleInAnySpelling) {
  const fs::path out = folder_ / "out.exr";
  roles_.writes("-o", out);
  EXPECT_EQ(refused(out), "-o and --stats would both write " + out.string() + "; choose another name for one of them");
  fs::create_directory(folder_ / "sub");
  EXPECT_NE(refused(folder_ / "sub/../out.exr").find("the same file"), std::string::npos);
  fs::create_directory_symlink(folder_ / "sub" / "..", folder_ / "link");
  EXPECT_NE(refused(folder_ / "link/out.exr").find("the same file"), std::string::npos);
  EXPECT_NE(refused(fs::relative(out)).find("the same file"), std::string::npos);
  EXPECT_EQ(refused(folder_ / "sub/out.exr"), "");
  EXPECT_EQ(refused(folder_ / "other.exr"), "");
}

TEST_F(FileRolesTest, LinksToANewFileAreThatFile) {
  roles_.writes("-o", folder_ / "out.exr");
  fs::create_symlink("out.exr", folder_ / "first");
  fs::create_symlink("first", folder_ / "second");
  EXPECT_NE(refused(folder_ / "first").find("the same file"), std::string::npos);
  EXPECT_NE(refused(folder_ / "second").find("the same file"), std::string::npos);
  fs::create_symlink("other.exr", folder_ / "third");
  EXPECT_EQ(refused(folder_ / "third"), "");
}

TEST_F(FileRolesTest, InputsCannotBeOutputs) {
  const fs::path scene = existing("room.gltf");
  roles_.reads("SCENE", scene);
  EXPECT_EQ(refused(scene),
            "--stats would replace " + scene.string() + ", which SCENE reads; choose another name for --stats");
  fs::create_symlink(scene, folder_ / "symbolic");
  fs::create_hard_link(scene, folder_ / "hard");
  EXPECT_NE(refused(folder_ / "symbolic"), "");
  EXPECT_NE(refused(folder_ / "hard"), "");
}

TEST_F(FileRolesTest, ChecksInputsAddedLater) {
  const fs::path texture = existing("wood.png");
  roles_.writes("-o", texture);
  EXPECT_NE(refusal_of([&] {
              roles_.reads("SCENE", std::vector<fs::path>{"", folder_ / "missing.png", texture});
            }).find("-o would replace "),
            std::string::npos);
}

TEST_F(FileRolesTest, FindsOutputsUnderAnyName) {
  const fs::path view = existing("view.json");
  roles_.writes("save-view", view);
  roles_.writes("save", folder_ / "new.exr");
  roles_.reads("SCENE", existing("room.gltf"));
  fs::create_symlink(view, folder_ / "link.json");
  EXPECT_TRUE(roles_.has_output(folder_ / "link.json"));
  EXPECT_TRUE(roles_.has_output(folder_ / "." / "new.exr"));
  EXPECT_FALSE(roles_.has_output(folder_ / "room.gltf"));
  EXPECT_FALSE(roles_.has_output(""));
}

TEST_F(FileRolesTest, OneRoleMayReadAndWriteAFile) {
  const fs::path checkpoint = existing("a.ckpt");
  roles_.reads("--resume", checkpoint);
  roles_.writes("--resume", checkpoint);
  roles_.writes("--resume", checkpoint);
  const fs::path image = existing("a.exr");
  roles_.reads("A", image);
  roles_.reads("B", image);
}

TEST_F(FileRolesTest, DevicesMayHaveAnyRole) {
  roles_.reads("SCENE", "/dev/null");
  roles_.writes("-o", "/dev/null");
  roles_.writes("--stats", "/dev/null");
}

TEST_F(FileRolesTest, DetectsUnwritableOutputs) {
  const auto problem = [&](const fs::path& file) { return refusal_of([&] { check_output_file(file); }); };
  EXPECT_EQ(problem(folder_ / "out.exr"), "");
  EXPECT_EQ(problem(folder_ / (std::string(251, 'a') + ".exr")), "");
  EXPECT_EQ(problem("/dev/null"), "");
  EXPECT_NE(problem(folder_ / (std::string(252, 'a') + ".exr")).find("has 256 bytes, but may have 255"),
            std::string::npos);
  fs::path deep = folder_ / "a";
  while (deep.string().size() < 4096) deep /= std::string(200, 'b');
  EXPECT_NE(problem(deep).find("but may have 4095 at most"), std::string::npos);
  EXPECT_NE(problem(folder_ / std::string(256, 'a') / "out.exr").find("has 256 bytes"), std::string::npos);
  EXPECT_NE(problem(folder_ / "missing" / "out.exr").find("does not exist; create it"), std::string::npos);
  EXPECT_NE(problem(folder_ / "").find("is a folder"), std::string::npos);
  EXPECT_NE(problem("/proc/out.exr"), "") << "not even for root";
  EXPECT_EQ(folder_.file_count(), 0u);
}

TEST_F(FileRolesTest, LongNamesAreCutBetweenCharacters) {
  std::string name;
  for (int i = 0; i < 100; ++i) name += "\u20ac";  // three bytes in UTF-8; at most 80 are shown
  const std::string problem = refusal_of([&] { check_output_file(name); });
  EXPECT_EQ(problem.find(name.substr(0, 78) + "…: "), 0u) << problem;
}

TEST_F(FileRolesTest, DetectsPathsTooLongForTemporaryNames) {
  fs::path folder = folder_ / "d";
  while (folder.string().size() < 3800) folder /= std::string(200, 'd');
  folder /= std::string(4090 - folder.string().size() - 1, 'd');
  fs::create_directories(folder);
  EXPECT_NE(refusal_of([&] { check_output_file(folder / "a"); }).find("File name too long"), std::string::npos);
}

}  // namespace
}  // namespace relume::cli
