// Writes the fuzzers' seed corpora: make_seeds FOLDER makes FOLDER/gltf, FOLDER/obj, … for fuzz_gltf, fuzz_obj, ….
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "checkpoint_case.h"
#include "experiments/measure/trace_file.h"
#include "experiments/output/results.h"
#include "image/ktx2/testing/ktx2_file.h"
#include "image/testing/webp.h"
#include "record_case.h"
#include "relume/image_io.h"
#include "render/settings.h"
#include "scene_io/testing/example_files.h"
#include "scene_io/testing/serialized_file.h"
#include "serve/testing/example_messages.h"
#include "settings/settings_json.h"
#include "viewer/model/camera_path.h"

namespace {

namespace fs = std::filesystem;
using relume::Bytes;

void write(const fs::path& file, const Bytes& bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// `bytes` after a byte that selects a target's case.
Bytes behind(int choice, Bytes bytes) {
  bytes.insert(bytes.begin(), static_cast<std::byte>(choice));
  return bytes;
}

void write_scenes(const fs::path& folder) {
  const std::vector<std::string> by_assimp = {"fbx", "dae", "stl", "3ds", "off"};  // in the order of fuzz_assimp
  for (const relume::testing::ExampleFile& file : relume::testing::example_files()) {
    const std::string extension = fs::path(file.name).extension().string().substr(1);
    const auto format = std::find(by_assimp.begin(), by_assimp.end(), extension);
    if (format != by_assimp.end()) {
      write(folder / "assimp" / file.name, behind(static_cast<int>(format - by_assimp.begin()), file.bytes));
    } else {
      const std::string target = extension == "glb" ? "gltf" : extension == "xml" ? "mitsuba" : extension;
      write(folder / target / file.name, file.bytes);
    }
    if (extension == "obj") write(folder / "mitsuba" / file.name, behind(1, file.bytes));
  }
  for (const uint16_t version : {uint16_t{3}, uint16_t{4}, uint16_t{5}})
    write(folder / "mitsuba" / (std::to_string(version) + ".serialized"),
          behind(0, relume::testing::serialized_file(version)));
}

void write_images(const fs::path& folder) {
  write(folder / "texture" / "solid.png", relume::testing::solid_png(3, 2, 1, 2, 3, 4));
  const std::vector<uint8_t> rgba = {1, 2, 3, 4, 250, 251, 252, 253};
  write(folder / "texture" / "lossless.webp", relume::testing::make_webp(2, 1, rgba));
  write(folder / "texture" / "lossy.webp", relume::testing::make_webp(2, 1, rgba, 80));
  for (const char* name : {"a.exr", "a.hdr", "a.jpg", "a.tga"})
    relume::write_image(folder / "texture" / name, relume::Image(3, 2));
}

void write_ktx2(const fs::path& folder) {
  const relume::testing::Ktx2File plain = relume::testing::plain_ktx2();
  const relume::testing::Ktx2File uastc = relume::testing::uastc_ktx2();
  write(folder / "ktx2" / "plain.ktx2", plain.bytes());
  write(folder / "ktx2" / "uastc.ktx2", uastc.bytes());
  write(folder / "ktx2" / "zstandard.ktx2", relume::testing::with_zstandard(uastc).bytes());
  for (const bool alpha : {false, true})
    write(folder / "ktx2" / (alpha ? "rgba.ktx2" : "rgb.ktx2"), relume::testing::small_etc1s_ktx2(alpha).bytes());
}

void write_settings(const fs::path& folder) {
  relume::AllSettings settings;
  const std::string text = relume::settings_to_json(relume::describe(settings));
  write(folder / "settings" / "all.json", relume::testing::to_bytes(text));
  write(folder / "settings" / "nested.json",
        relume::testing::to_bytes("{\"path\": {\"russian-roulette\": false}, /* none */ \"spp\": 4}"));
  relume::ExrFile exr;
  exr.width = 3;
  exr.height = 2;
  exr.channels = relume::exr_channels(relume::Image(3, 2));
  exr.attributes = {{"relume.settings", text}, {"relume.seed", "0"}};
  fs::create_directories(folder / "exr");
  relume::write_exr(folder / "exr" / "settings.exr", exr);
}

void write_checkpoints(const fs::path& folder) {
  const fs::path whole = folder / "whole.checkpoint";
  for (int choice = 0; choice < relume::fuzz::kCheckpointCases; ++choice) {
    relume::Session session = relume::fuzz::checkpoint_session(choice);
    for (int i = 0; i < 3; ++i) session.render_frame();
    session.save_checkpoint(whole);
    std::string checkpoint = relume::fuzz::contents(whole);
    checkpoint.resize(checkpoint.size() - sizeof(uint64_t));  // without the checksum
    write(folder / "checkpoint" / std::to_string(choice),
          behind(choice, relume::testing::to_bytes(checkpoint.substr(relume::fuzz::header_size(checkpoint)))));
    write(folder / "checkpoint" / (std::to_string(choice) + "-with-header"),
          behind(choice + relume::fuzz::kWithHeader, relume::testing::to_bytes(checkpoint)));
  }
  fs::remove(whole);
}

void write_records(const fs::path& folder) {
  using relume::fuzz::RecordKind;
  const fs::path whole = folder / "whole.record";
  const auto add = [&](RecordKind kind, const std::string& name, const std::string& record) {
    write(folder / "records" / name, behind(static_cast<int>(kind), relume::testing::to_bytes(record)));
  };
  relume::ExperimentResult result;
  result.claims.push_back({"id", "[Paper00 §1]", "It is less.", "0.5", "at most 1", "holds"});
  const relume::Experiment experiment{"name", "[Paper00]", "a summary", nullptr};
  add(RecordKind::summary, "summary.json",
      relume::to_json(experiment, result, {{{"processor", "two cores"}}, true, 3}));

  relume::Trace trace{.name = "path", .points = {{1, 1, 0.5, 0.1, 0.2}, {2, 2, 1, 0.05, 0.1}}};
  trace.image = relume::Image(4, 3);
  trace.map.assign(12, 0.5f);
  relume::save_traces(whole, {trace, trace});
  add(RecordKind::traces, "traces.exr", relume::fuzz::contents(whole));

  relume::fuzz::SmallReference reference(folder / "references");
  reference.render();
  add(RecordKind::reference, "reference.exr", relume::fuzz::contents(reference.file()));

  relume::viewer::write_bookmarks(whole, {{"a", {}}, {"b", {relume::Vec3(1, 2, 3), {0, 1, 0, 0}, 1}}});
  add(RecordKind::bookmarks, "bookmarks.json", relume::fuzz::contents(whole));
  add(RecordKind::script, "script.txt", "frames 3 # so many\nkey shift+f12 2\nset spp 4\nscreenshot a b.png\n");
  fs::remove(whole);
  fs::remove_all(folder / "references");
}

void write_messages(const fs::path& folder) {
  const std::vector<std::string> messages = relume::serve::testing::example_messages();
  for (size_t i = 0; i < messages.size(); ++i)
    write(folder / "message" / std::to_string(i), behind(0, relume::testing::to_bytes(messages[i])));
  const std::string host = "render.example.com:8464";
  write(folder / "message" / "page", behind(1, relume::testing::to_bytes("GET\n/main.js\n" + host + "\n\n")));
  write(folder / "message" / "socket",
        behind(2, relume::testing::to_bytes("GET\n/socket\n" + host + "\nhttps://" + host + "\n")));
}

/// libFuzzer's dictionary of words that messages and requests consist of.
void write_message_words(const fs::path& folder) {
  std::vector<std::string> words = relume::serve::testing::example_words();
  for (const char* word : {"GET", "HEAD", "POST", "/", "/socket", "/main.js", "127.0.0.1", "localhost", "[::1]",
                           "render.example.com", "http://", "https://", ":8464", "null", "true", "false", "\\u0000"})
    words.emplace_back(word);
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  std::ofstream out(folder / "message.dict");
  for (const std::string& word : words) {
    out << '"';
    for (const char c : word) out << (c == '"' || c == '\\' ? "\\" : "") << c;
    out << "\"\n";
  }
}

void write_command_lines(const fs::path& folder) {
  const char* const texts[] = {"default,psf=cache:psf,interactive,max-bounces:3,b=preview",
                               "a.exr,cycles=b.exr",
                               "1h30min",
                               "0-99",
                               "frames/a.####.png",
                               "vlc.bucket-size=16"};  // in the order of fuzz_command_line
  for (int kind = 0; kind < static_cast<int>(std::size(texts)); ++kind)
    write(folder / "command_line" / std::to_string(kind), behind(kind, relume::testing::to_bytes(texts[kind])));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_seeds FOLDER\n");
    return 1;
  }
  write_scenes(argv[1]);
  write_images(argv[1]);
  write_ktx2(argv[1]);
  write_settings(argv[1]);
  write_checkpoints(argv[1]);
  write_records(argv[1]);
  write_command_lines(argv[1]);
  write_messages(argv[1]);
  write_message_words(argv[1]);
  return 0;
}
