// Fuzzes files that the program writes and reads: results of experiments, partial measurements, cached references, the
// viewer's bookmarks and scripts. Any bytes give a record or an Error. The first byte selects the kind.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "experiments/measure/adapted_file.h"
#include "experiments/measure/moving_file.h"
#include "experiments/measure/trace_file.h"
#include "experiments/output/results.h"
#include "record_case.h"
#include "relume/error.h"
#include "scratch.h"
#include "viewer/model/camera_path.h"
#include "viewer/model/script.h"

namespace {

using relume::fuzz::RecordKind;

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

void read_reference(const std::string& text) {
  static const relume::fuzz::Scratch folder(".references");
  static relume::fuzz::SmallReference reference(folder.path);
  write(reference.file(), text);
  reference.render();
}

void read_record(RecordKind kind, const std::string& text) {
  static const relume::fuzz::Scratch scratch(".record");
  switch (kind) {
    case RecordKind::summary: relume::read_summary(text, "fuzz.json"); return;
    case RecordKind::traces:
      write(scratch.path, text);
      relume::load_traces(scratch.path);
      relume::load_adapted(scratch.path);
      relume::load_moving(scratch.path);
      return;
    case RecordKind::reference: read_reference(text); return;
    case RecordKind::bookmarks:
      write(scratch.path, text);
      relume::viewer::read_bookmarks(scratch.path);
      return;
    case RecordKind::script:
      for (const relume::viewer::ScriptStep& step : relume::viewer::parse_script(text, "fuzz.txt")) {
        if (step.words.empty()) continue;
        if (step.verb == "key") relume::viewer::parse_keys(step.words[0], "fuzz.txt");
        if (step.verb == "sun") relume::viewer::number_in(step.words[0]);
      }
      return;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  try {
    read_record(static_cast<RecordKind>(data[0] % relume::fuzz::kRecordKinds),
                {reinterpret_cast<const char*>(data) + 1, size - 1});
  } catch (const relume::Error&) {
    // Expected for damaged input.
  }
  return 0;
}
