#include "scene_io/assimp/assimp_messages.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(AssimpMessages, KeepTheLineNumberAndText) {
  EXPECT_EQ(explain_assimp_problem("FBX-Tokenize (line 12 <<  col 3) unexpected double-quote"),
            "line 12: its structure is damaged; export it again or convert it to glTF");
  EXPECT_EQ(explain_assimp_problem("Cannot parse string \"x 2\" as a real number: does not start with digit"),
            "a number is expected (near 'x 2'); export it again or convert it to glTF");
  EXPECT_EQ(explain_assimp_problem("Cannot parse string \"\x01\xff\" as a real number"),
            "a number is expected; export it again or convert it to glTF");
  EXPECT_EQ(explain_assimp_problem("The string \"" + std::string(100, 'b') + "\" cannot be converted into a value."),
            "a number is expected (near '" + std::string(24, 'b') + "...'); export it again or convert it to glTF");
}

TEST(AssimpMessages, HaveSpecificRemedies) {
  EXPECT_EQ(explain_assimp_problem("Validation failed: aiScene::mNumMeshes is 0. At least one mesh must be there"),
            kNoTriangles);
  EXPECT_NE(explain_assimp_problem("FBX-DOM unsupported, old format version").find("export it as FBX 2013"),
            std::string::npos);
}

TEST(AssimpMessages, HaveAFallback) {
  const std::string fallback = "the file's content is damaged or not supported; export it again or convert it to glTF";
  EXPECT_EQ(explain_assimp_problem(""), fallback);
  EXPECT_EQ(explain_assimp_problem("DeadlyImportError: aiFoo::mBar \"secret\""), fallback);
  EXPECT_EQ(explain_assimp_problem("line 7, no idea"), "line 7: " + fallback);
  EXPECT_EQ(explain_assimp_problem("an unclosed \" quote"), fallback);
}

}  // namespace
}  // namespace relume
