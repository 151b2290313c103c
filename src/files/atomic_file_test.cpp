#include "files/atomic_file.h"

#include <sys/wait.h>
#include <unistd.h>

#include <deque>
#include <string>

#include <gtest/gtest.h>

#include "files/testing/temp_folder.h"
#include "relume/error.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  const auto bytes = read_file(file);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(AtomicFile, AppearsOnlyOnCommit) {
  const TempFolder folder;
  {
    AtomicFile file(folder / "a.txt");
    file.stream() << "hello";
    EXPECT_FALSE(fs::exists(folder / "a.txt"));
    file.commit();
  }
  EXPECT_EQ(text_of(folder / "a.txt"), "hello");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, WithoutCommitOnlyTheOldFileRemains) {
  const TempFolder folder;
  write_file(folder / "a.txt", "old");
  {
    AtomicFile file(folder / "a.txt");
    file.stream() << "new";
  }
  EXPECT_EQ(text_of(folder / "a.txt"), "old");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, ReplacesAndFollowsLinks) {
  const TempFolder folder;
  write_file(folder / "target.txt", "old");
  fs::create_symlink(folder / "target.txt", folder / "link.txt");
  write_file(folder / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(text_of(folder / "target.txt"), "new");
}

TEST(AtomicFile, FollowsLinksToFilesThatDoNotExist) {
  const TempFolder folder;
  fs::create_directory(folder / "sub");
  fs::create_symlink("sub/second.txt", folder / "first.txt");
  fs::create_symlink("../target.txt", folder / "sub/second.txt");
  write_file(folder / "first.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "first.txt"));
  EXPECT_TRUE(fs::is_symlink(folder / "sub/second.txt"));
  EXPECT_EQ(text_of(folder / "target.txt"), "new");
}

TEST(LinkTarget, IsTheFileItselfWhereLinksGoInCircles) {
  const TempFolder folder;
  fs::create_symlink("b", folder / "a");
  fs::create_symlink("a", folder / "b");
  EXPECT_EQ(link_target(folder / "a"), folder / "a");
  EXPECT_EQ(link_target(folder / "none"), folder / "none");
}

TEST(AtomicFile, AcceptsNamesOfMaximumLength) {
  const TempFolder folder;
  for (const size_t stem : {251u, 100u, 1u}) {
    const std::string name = std::string(stem, 'a') + "." + std::string(254 - stem, 'x');
    write_file(folder / name, "hello");
    EXPECT_EQ(text_of(folder / name), "hello");
  }
}

/// Runs `task` in a child process that ends without destructors, as if killed.
template <typename Task>
void run_in_child(const Task& task) {
  const pid_t child = fork();
  if (child == 0) {
    task();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(AtomicFile, NextWriteRemovesFilesOfKilledWriters) {
  const TempFolder folder;
  for (const char* name : {"a.txt", "a.txt", "b.txt"}) {
    run_in_child([&] { (new AtomicFile(folder / name))->stream() << "half" << std::flush; });
  }
  // The second writer of a.txt removed the first one's temporary file.
  EXPECT_EQ(folder.file_count(), 2u);
  write_file(folder / "a.txt", "whole");
  EXPECT_EQ(folder.file_count(), 2u);
  write_file(folder / "b.txt", "whole");
  EXPECT_EQ(folder.file_count(), 2u);
  EXPECT_EQ(text_of(folder / "a.txt") + text_of(folder / "b.txt"), "wholewhole");
}

TEST(AtomicFile, WritersKeepEachOthersFiles) {
  const TempFolder folder;
  AtomicFile first(folder / "a.txt");
  AtomicFile second(folder / "a.txt");
  EXPECT_EQ(folder.file_count(), 2u);
  run_in_child([&] { write_file(folder / "a.txt", "child"); });
  EXPECT_EQ(text_of(folder / "a.txt"), "child");
  second.stream() << "second";
  second.commit();
  EXPECT_EQ(text_of(folder / "a.txt"), "second");
  first.stream() << "first";
  first.commit();
  EXPECT_EQ(text_of(folder / "a.txt"), "first");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, ManyWritersOfOneNameFindATemporaryName) {
  const TempFolder folder;
  std::deque<AtomicFile> writers;
  for (int i = 0; i < 40; ++i) writers.emplace_back(folder / "a.txt").stream() << i;
  EXPECT_EQ(folder.file_count(), 40u);
  for (AtomicFile& writer : writers) writer.commit();
  EXPECT_EQ(text_of(folder / "a.txt"), "39");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(PendingFile, IsWrittenDirectlyByItsOwner) {
  const TempFolder folder;
  PendingFile pending(folder / "a.txt");
  write_file(pending.path(), "hello");
  EXPECT_EQ(folder.file_count(), 1u);
  // The file is still locked; another writer must not treat it as stale.
  run_in_child([&] { write_file(folder / "a.txt", "child"); });
  pending.commit();
  EXPECT_EQ(text_of(folder / "a.txt"), "hello");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(TemporaryFiles, AreRemovedWhereASignalEndsTheProcess) {
  const TempFolder folder;
  run_in_child([&] {
    (new AtomicFile(folder / "a.txt"))->stream() << "half" << std::flush;
    (new PendingFile(folder / "b.txt"));
    remove_temporary_files();
  });
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(WriteFiles, ReplacesAllOrNone) {
  const TempFolder folder;
  write_files({{folder / "a.txt", "old"}, {folder / "b.txt", "old"}});
  EXPECT_THROW(write_files({{folder / "a.txt", "new"}, {folder / "b.txt", "new"}, {folder / "no" / "c.txt", ""}}),
               Error);
  EXPECT_EQ(text_of(folder / "a.txt"), "old");
  EXPECT_EQ(text_of(folder / "b.txt"), "old");
  EXPECT_EQ(folder.file_count(), 2u);
  write_files({{folder / "a.txt", "new"}, {folder / "b.txt", "newer"}});
  EXPECT_EQ(text_of(folder / "a.txt"), "new");
  EXPECT_EQ(text_of(folder / "b.txt"), "newer");
}

TEST(AtomicFile, WritesDevicesDirectly) {
  if (!fs::is_character_file("/dev/null")) GTEST_SKIP() << "no /dev/null here";
  write_file("/dev/null", "gone");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(AtomicFile, ReportsAFullDisk) {
  if (!fs::is_character_file("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THROW(write_file("/dev/full", "x"), Error);
}

TEST(AtomicFile, MissingFolderAndFolderAsFileAreErrors) {
  const TempFolder folder;
  EXPECT_THROW(AtomicFile(folder / "missing" / "a.txt"), Error);
  EXPECT_THROW(AtomicFile(folder / ""), Error);
  EXPECT_THROW(read_file(folder / "missing.txt"), Error);
  EXPECT_THROW(read_file(folder / ""), Error);
}

TEST(ReadFile, RefusesFilesAboveTheLimit) {
  const TempFolder folder;
  write_file(folder / "a.txt", "12345");
  EXPECT_EQ(read_file(folder / "a.txt", 5).size(), 5u);
  EXPECT_THROW(read_file(folder / "a.txt", 4), Error);
}

}  // namespace
}  // namespace relume
