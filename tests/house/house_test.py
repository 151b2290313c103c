#!/usr/bin/env python3
"""Tests of the house checks: each finds the problems that it covers."""

import contextlib
import importlib.machinery
import importlib.util
import io
import pathlib
import re
import shutil
import sys
import tempfile
import unittest
from unittest import mock

import check_files
import check_kernels
import check_layers
import check_places
import check_program_tests
import check_prose
import check_sources
import check_spelling
import check_wording
import house

FUNCTIONS = """
namespace a {
template <class T, typename U = int>
T first(T x = {}) {
  if (x) { return "}"; }  // {
  return x;
}
enum class E { a, b };
const int kTable[] = {1, 2,
  3};
class C final : public B<int(int)> {
 public:
  C() : b_{1}, c_(2) {
  }
  bool operator==(const C& o) const { return b_ == o.b_; }
  int b_{0}; int c_ = '{';
};
#define M { \\
  {
}
"""


class Repository(unittest.TestCase):
    """A scratch repository that a test fills."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = pathlib.Path(scratch.name)

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def assert_finds(self, check, *expected):
        """`check` reports exactly one problem for each expected part of a sentence, in that order."""
        problems = check(self.root)
        self.assertEqual(len(problems), len(expected), problems)
        for problem, part in zip(problems, expected):
            self.assertIn(part, problem)

    def test_layers(self):
        self.write("src/core/a.h", '#include <cmath>\n#include "core/b.h"\n// #include "relume/image_io.h"\n')
        self.write("src/core/b.h", '#include "scene/scene.h"\n#include "b.h"\n')
        self.write("src/core/b_test.cpp", '#include "scene/scene.h"\n')
        self.write("src/scene_io/a.cpp", "#include <tiny_gltf.h>\n")
        self.write("src/scene_io/a.h", "#include <tiny_gltf.h>\n")
        self.write("src/scene/a.cpp", "#include <assimp/scene.h>\n")
        self.write("src/techniques/transport/path/a.h", '#include "techniques/transport/bdpt/b.h"\n#include "techniques/light_sampling/light_selection/a.h"\n')
        self.write("src/techniques/light_sampling/light_selection/a.h", '#include "techniques/transport/bdpt/b.h"\n')
        self.write("src/other/a.h", "\n")
        self.write("include/relume/a.h", '#include "core/a.h"\n#include "relume/b.h"\n')
        self.write("src/render/a.h", '#include "compare/a.h"\n')
        self.write("lab/compare/a.h", '#include "experiments/a.h"\n')
        self.write("apps/a.cpp", '#include "core/a.h"\n#include <embree3/rtcore.h>\n')
        self.write("apps/relume/viewer/app.cpp", '#include "viewer/panels/a.h"\n')
        self.write("apps/relume/viewer/model/a.cpp", '#include "viewer/model/a.h"\n#include "viewer/render/a.h"\n#include "cli/a.h"\n#include "viewer/app.h"\n')
        self.write("apps/relume/viewer/model/a_test.cpp", '#include "viewer/panels/a.h"\n')
        self.write("apps/relume/viewer/render/a.h", '#include "viewer/model/a.h"\n')
        self.write("python/bindings/a.cpp", '#include "b.h"\n#include "relume/scene.h"\n#include "render/session.h"\n')
        self.write("tools/a.cpp", '#include "materials/a.h"\n#include "render/a.h"\n#include "b.h"\n#include <embree3/rtcore.h>\n')
        self.assert_finds(
            check_layers.check, "only accel may use", "model may include render", "render may include nothing", "the public interface includes only itself", "compare may include", "the bindings include only", "core may include nothing", "not a path from src/ or lab/",
            "not in the table", "render may include", "only scene_io may use", "slow to compile", "include another technique", "tools may include core materials",
            "tools/a.cpp:3: #include of b.h: is not a path", "only accel may use")

    def test_table_of_layers(self):
        self.assertEqual(check_layers.check_table({"a": "b", "b": ""}), [])
        self.assertIn("cycle", check_layers.check_table({"a": "b", "b": "a"})[0])
        self.assertIn("has no row for b", check_layers.check_table({"a": "b"})[0])

    def test_unused_permissions(self):
        self.write("src/scene_io/a.h", '#include "core/a.h"\n')
        self.write("src/scene_io/a_test.cpp", '#include "scene/a.h"\n')
        self.write("src/techniques/transport/bdpt/a.h", '#include "techniques/transport/path/a.h"\n')
        self.write("tools/a.cpp", '#include "materials/a.h"\n')
        unused = check_layers.unused_permissions(self.root, {"io": "core scene", "techniques": "", "tools": "lights materials"}, {"bdpt": "path octree"})
        self.assertEqual([problem.split(",")[0] for problem in unused], ["the table lets io include scene", "the table lets tools include lights", "the table lets bdpt include octree"])

    def test_functions_are_measured(self):
        found = check_sources.functions(FUNCTIONS)
        self.assertEqual([(name, length) for name, _, length in found], [("first", 5), ("C", 2), ("operator==", 1)])
        self.assertRaises(ValueError, check_sources.functions, "void f() {")

    def test_lengths(self):
        self.write("src/core/a.h", "\n" * 401)
        self.write("src/core/b.h", "void f() {" + "\n" * 60 + "}\nvoid g() {" + "\n" * 59 + "}\n")
        self.assert_finds(check_sources.check, "401 lines", "f has 61 lines")

    def test_sources(self):
        self.write("docs/bibliography.md", "- [Known01]\n")
        self.write("src/scene/a.h", "// [Known01, eq. 2] [Lost02 eq. 3] [Lost03]\nint a[3];\n#ifdef __CUDACC__\n#endif\n")
        self.write("scripts/run", "# TO" "DO: more\n")
        self.assert_finds(check_sources.check, "unfinished work", "a.h:3: __CUDACC__", "[Lost02]", "[Lost03]")

    def test_disk_calls_that_throw(self):
        self.write("src/files/a.cpp", "\n".join((
            "bool b(const fs::path& a, std::error_code& c) { return fs::is_empty(a, c) && std::filesystem::exists(a); }",
            "void f() {",
            "  std::error_code failure;",
            "  const auto status = fs::status(a(1, {2}), failure);",
            "  if (fs::exists(status) && fs::is_directory(link_target(a))) fs::create_directories(",
            "      a.parent_path());",
            "  for (auto i = fs::directory_iterator(a, failure); i != fs::directory_iterator(); ++i) fs::remove(i->path(), other);",
            "  const fs::directory_iterator first(a);",
            "  std::remove(\"fs::exists(a)\"); fs::temp_directory_path();  // fs::exists(a)",
            "}\n")))
        for name in ("src/files/testing/a.h", "src/files/a_test.cpp", "tests/fuzz/a.cpp"):
            self.write(name, "const bool is_there = fs::exists(a);\n")
        self.assert_finds(
            check_sources.check, "a.cpp:1: std::filesystem::exists throws", "a.cpp:5: std::filesystem::is_directory", "a.cpp:5: std::filesystem::create_directories",
            "a.cpp:7: std::filesystem::remove", "a.cpp:8: std::filesystem::directory_iterator", "a.cpp:9: std::filesystem::temp_directory_path")

    def test_kernels(self):
        self.write("src/techniques/transport/path/kernels.inc", "RELUME_KERNEL(relume::OwnKernel);\n// RELUME_KERNEL(relume::Forgotten);\nRELUME_KERNEL(relume::Copy<relume::Light>);\nRELUME_GROUP_KERNEL(relume::GroupKernel);\n")
        self.write("src/techniques/transport/path/a.h", "\n".join((
            "struct OwnKernel : Base {",
            "  SceneView scene;  // int* a;",
            "  View<const Record> records;",
            "  uint32_t* longest = nullptr;",
            "  alignas(16) float sums[4] = {1, 2};",
            "  void operator()(const Tile& tile) const { float* row = &sums[0]; }",
            " private:",
            "  const Settings& settings;",
            "};",
            "struct Base { using Policy = Walker; union { Far far; int near{0}; }; };",
            "struct Walker { const OwnKernel* kernel; };",
            "struct Forgotten { int* a; };",
            "template <typename T> struct Copy { T value; };",
            "struct GroupKernel { float* sums; };",
            "")))
        self.write("src/scene/a.h", "\n".join((
            "struct alignas(32) Record { View<float> values; int mesh; };",
            "struct SceneView { HostAccel host; std::span<int> ids; View<const int*> links; static const int* all; float Light::*member(); };",
            "struct LightsView { TableView tables; };",
            "using TableView = Tables<Entry>;",
            "struct Entry { const float* row; };",
            "struct Light { Kind kind; };",
            "struct HostAccel { const void* data; };",
            "")))
        self.write("src/core/view.h", "template <typename T> struct View { T* data; };\nstruct Far { int (*f)(int); };\n")
        self.write("src/scene/testing/b.h", "struct Light { int* a; };\n")
        self.assert_finds(
            check_kernels.check, "core/view.h:2: Far, which kernel or view OwnKernel reaches, holds a pointer: int (*f)(int)",
            "scene/a.h:1: Record, an element of an array that OwnKernel reaches, holds a view: View<float> values", "scene/a.h:2: SceneView", "scene/a.h:2: SceneView",
            "scene/a.h:5: Entry", "a.h:14: GroupKernel", "a.h:4: OwnKernel, which kernel or view OwnKernel reaches, holds a pointer: uint32_t* longest", "a.h:8: OwnKernel")

    def test_files(self):
        self.write("src/techniques/transport/path/README.md", "# Path\n| When to use it | always |\n")
        self.write("src/techniques/denoise/mute/README.md", "# Mute\n")
        self.write("src/techniques/denoise/mute/mute_bench.cpp", "\n")
        self.write("src/techniques/denoise/mute/mute_test.cpp", "\n")
        self.write("src/techniques/transport/path/path_test.cpp", "\n")
        self.write("src/techniques/transport/path/lost_test.cpp", "\n")
        self.write("src/techniques/CMakeLists.txt", "relume_add_tests(a denoise/mute/mute_test.cpp transport/path/path_test.cpp)  # transport/path/lost_test.cpp\n")
        self.write("out/large.bin", "x" * (1 << 21))
        self.write("docs/large.bin", "x" * ((1 << 20) + 1))
        self.write("docs/images/shown.jpg", "")
        self.write("docs/images/unused.webp", "")
        self.write("README.md", "# Two words\n[a](docs) [b](#two-words) [c](https://x.y) `[d](e)`\n[f](lost.md) [g](#lost)\n![h](docs/images/shown.jpg)\n" + "\n" * 117)
        self.assert_finds(
            check_files.check, "mute/README.md: has no row that says when", "no benchmark", "lost_test.cpp: no CMakeLists.txt", "large.bin: 1048577 bytes; at most", "README.md: 121 lines", "README.md:3: the link to lost.md",
            "no heading 'lost'", "unused.webp: no page shows")

    @unittest.skipUnless(shutil.which("codespell"), "no codespell")
    def test_spelling(self):
        typo = "".join(("t", "e", "h"))  # which the check itself does not see
        self.write("README.md", f"the\n{typo} end\n")
        self.write("src/core/a.h", f"int {typo} = 1;\n// {typo} comment\nconst char* s = \"{typo} string\\nmean\";\n")
        self.write("scripts/run", f"# {typo}\n")
        self.write("tests/a.py", f"{typo} = 1  # {typo} comment\n")
        self.write("docs/results.json", f'"{typo}"\n')
        self.assert_finds(check_spelling.check, "README.md:2", "scripts/run:1", "src/core/a.h:2", "src/core/a.h:3", "tests/a.py:1")

    def test_wording(self):
        self.write("src/core/a.cpp", 'f("all but "\n  "for one");\n// anew\ng("it go" "es on;", "stands in", "is mended");\n')
        self.write("src/core/a_test.cpp", 'f("anew");\n')
        self.write("src/core/b.cpp", 'f("standard, butter, amended, it stands in the corner");\n')
        self.assert_finds(check_wording.check, "a.cpp:1: 'but for'", "a.cpp:4: 'goes on'", "a.cpp:4: 'stands in'", "a.cpp:4: 'mended'", "a_test.cpp:1: 'anew'")

    def test_wording_of_scripts(self):
        self.write("CMakeLists.txt", "project(a)\n# built anew\n")
        self.write("scripts/run", "#!/bin/sh\nfail \"$file is not there\"\n")
        self.write("tests/package/use", '#!/bin/sh\n[ -e "$a" ] || fail "it was refused with a sentence"\n')
        self.write("tests/a.py", 'anew = 1  # by itself\nprint("whoever")\n')
        self.write("tests/house/house_test.py", '"anew"\n')
        self.write("src/a.json", '"anew"\n')
        self.assert_finds(
            check_wording.check, "CMakeLists.txt:2: 'anew'", "scripts/run:2: 'is not there'", "tests/a.py:1: 'by itself'", "tests/a.py:2: 'whoever'",
            "tests/package/use:2: 'refused with a sentence'")

    def test_wrapped_and_legitimate_phrases(self):
        found = [sentence.split("'")[1] for _, sentence in check_wording.calques(
            "One sample a\npixel; (who has no say). All count alike, a hair wider: nobody looks away. The cache knows what is\nleft.")]
        self.assertEqual(found, ["sample a pixel", "who", "has no say", "count alike", "a hair wider", "nobody", "looks away", "cache knows", "what is left"])
        found = [sentence.split("'")[1] for _, sentence in check_wording.calques(
            "In the mean, paths arrive where they like. Light is taken for noise: the lamp is there, what ended under it is still there.")]
        self.assertEqual(found, ["In the mean", "where they like", "is taken for", "is there", "what ended under", "is still there"])
        self.assertEqual(check_wording.calques("Is there a lamp? There is one. A sample counts as black in the mean. There are two; time taken for it."), [])
        self.assertEqual(check_wording.calques(
            "Users who look alike in the mean of a picturesque frame. A profile looks away from a hair: the samples. A pixel, the users: who is it?"), [])

    def test_prose(self):
        wide = "word " * 21
        self.write("README.md", f"# {wide}\n\n{wide}\n\n    {wide}\n\n```text\n{wide} anew\n```\n\n| {wide} |\n\n- item\n  {wide}\n\n`anew` anew.\n")
        self.write("docs/long.md", "\n".join(["all the " + "odd " * 18] * 2) + "odd ones.\n\nShort here now. " + "Five words are in this. " * 3 + "\n")
        self.assert_finds(
            check_prose.check, "README.md:1: 107 columns", "README.md:3: 105 columns", "README.md:14: 107 columns", "README.md:16: 'anew'",
            "docs/long.md:1: a sentence of 42 words")

    def test_median_of_sentences(self):
        self.write("README.md", ("Word " * 16 + "word.\n\n") * 3)
        self.assert_finds(check_prose.check, "the median sentence has 17 words")

    def test_prose_of_comments(self):
        self.write("src/core/a.h", 'int a;  ///< one sample a\n        ///< pixel\nf("anew");\n\n// `anew`\n/* by\n   itself */\n')
        self.write("src/core/b.h", "// " + "word " * 30 + "\n// " + "word " * 11 + "\n")
        self.assert_finds(check_prose.check_comments, "a.h:1: 'sample a pixel'", "a.h:6: 'by itself'", "b.h:1: a sentence of 41 words")

    def test_diagrams(self):
        loader = importlib.machinery.SourceFileLoader("technique_diagrams", str(house.ROOT / "tools/technique_diagrams"))
        tool = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
        loader.exec_module(tool)
        drawing = self.root / "diagram.svg"
        printed = io.StringIO()
        with mock.patch.multiple(tool, ROOT=self.root, pages=lambda: [("hash_grid", drawing)]), contextlib.redirect_stdout(printed):
            with mock.patch.object(sys, "argv", ["technique_diagrams", "--check"]):
                self.assertEqual(tool.main(), 1)
            with mock.patch.object(sys, "argv", ["technique_diagrams"]):
                self.assertEqual(tool.main(), 0)
            with mock.patch.object(sys, "argv", ["technique_diagrams", "--check"]):
                self.assertEqual(tool.main(), 0)
                drawing.write_text(drawing.read_text(encoding="utf-8") + " ", encoding="utf-8")
                self.assertEqual(tool.main(), 1)
        self.assertEqual(printed.getvalue().count("diagram.svg is out of date"), 2)

    def test_comments_keep_line_numbers(self):
        text = 'a /* 1\n2 */ b "// no" // c\nd R"(\n)" 1\'000\n'
        self.assertEqual(house.without_comments(text), 'a  \n b ""  \nd ""\n 1\'000\n')
        self.assertEqual([line for line, _ in house.comments(text)], [1, 2])


class Places(Repository):
    def places(self, most, folder=None):
        return check_places.check(self.root, [("the light type spot", re.compile(r"\bspot\b"), most, folder)])

    def test_counts_sources_without_comments_and_tests(self):
        self.write("src/lights/a.h", "enum { spot };\n")
        self.write("src/scene/a.cpp", "// spot\n")
        self.write("src/scene/a_test.cpp", "spot\n")
        self.write("src/scene/testing/a.h", "spot\n")
        self.assertEqual(self.places(1), [])
        self.write("src/scene/b.cpp", 'f("spot");\n')
        self.assertIn("is named in 2 places, not in the 1 of", self.places(1)[0])

    def test_counts_a_folder_once(self):
        self.write("src/io/spot/a.h", "int spot;\n")
        self.write("src/io/spot/a.cpp", "int spot;\n")
        self.assertEqual(self.places(1, "src/io/spot/"), [])

    def test_needs_a_representative(self):
        self.write("src/a/a.h", "int a;\n")
        self.assertIn("choose another representative", self.places(1)[0])


class ProgramTests(Repository):
    def setUp(self):
        super().setUp()
        self.write("tests/program/a_test.py", "class Base:\n  def test_x(self): pass\nclass Small(Base):\n  def test_y(self): pass\n")

    def list(self, text):
        self.write("tests/program/CMakeLists.txt", text)

    def test_each_method_runs_once(self):
        self.list("relume_add_program_test(a)\n")
        self.assert_finds(check_program_tests.check)
        self.list("foreach(part Base Small)\n  relume_add_program_part(${part} a ${part} LABELS slow)\nendforeach()\n")
        self.assert_finds(check_program_tests.check)

    def test_missing_repeated_and_unknown_tests(self):
        self.list("# relume_add_program_test(a)\nrelume_add_program_part(b a Small)\nrelume_add_program_part(c a Small.test_y)\n")
        self.assert_finds(check_program_tests.check, "runs Base.test_x 0 times", "runs Small.test_y 2 times")
        self.list("relume_add_program_test(a)\nrelume_add_program_part(b a Large)\n")
        self.assert_finds(check_program_tests.check, "has no test Large")

    def test_a_script_may_have_a_default(self):
        self.write("tests/program/a_test.py", 'class A:\n  def test_x(self): pass\nclass B:\n  def test_x(self): pass\nmain(defaultTest=sys.argv[1:] or "A")\n')
        self.list("relume_add_program_test(a)\n")
        self.assert_finds(check_program_tests.check, "runs B.test_x 0 times")
        self.list("relume_add_program_test(a)\nadd_test(NAME b\n  COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/a_test.py B)\n")
        self.assert_finds(check_program_tests.check)


if __name__ == "__main__":
    unittest.main()
