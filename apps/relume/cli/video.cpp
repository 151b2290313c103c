#include "cli/video.h"

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/file_roles.h"
#include "cli/image.h"
#include "core/srgb.h"
#include "files/extension.h"

namespace relume::cli {

bool is_video_file(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  return extension == ".mp4" || extension == ".y4m";
}

void check_video_file(const std::filesystem::path& file, const std::vector<std::string>& aovs) {
  check_layers(file, aovs);
  if (!program_exists("ffmpeg")) {
    throw UsageError(
        fmt::format("{}: videos are encoded by ffmpeg, which was not found; install it (apt install ffmpeg), or write "
                    "images: -o {}.####.png",
                    file.string(), file.stem().string()));
  }
  check_output_file(file);
}

VideoWriter::VideoWriter(std::filesystem::path file, int width, int height, float fps)
    : file_(std::move(file)), pending_(file_), bytes_(static_cast<size_t>(width) * static_cast<size_t>(height) * 3) {
  std::vector<std::string> command{"ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"};
  command.insert(command.end(), {"-s", fmt::format("{}x{}", width, height), "-r", fmt::format("{}", fps), "-i", "-"});
  // 4:2:0 needs even sizes: padding adds a black row or column. Players assume BT.709 for high definition.
  command.insert(command.end(), {"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv"});
  command.insert(command.end(), {"-pix_fmt", "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709"});
  command.insert(command.end(), {"-color_trc", "iec61966-2-1", "-color_range", "tv"});
  if (lower_extension(file_) == ".mp4") command.insert(command.end(), {"-crf", "17", "-movflags", "+faststart"});
  std::error_code failure;
  const std::filesystem::path target = std::filesystem::absolute(pending_.path(), failure);
  command.push_back((failure ? pending_.path() : target).string());
  encoder_ = std::make_unique<ChildPipe>(command);
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::add(const Image& image) {
  size_t i = 0;
  for (const Rgb& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) bytes_[i++] = quantise_unorm8(srgb_from_linear(pixel[c]));
  }
  if (!encoder_->write(bytes_.data(), bytes_.size())) fail();
}

void VideoWriter::finish() {
  if (encoder_->finish() != 0) fail();
  encoder_.reset();
  pending_.commit();
}

void VideoWriter::fail() const {
  throw Error(fmt::format("{}: ffmpeg could not encode the video; check the free space", file_.string()));
}

}  // namespace relume::cli
