#pragma once
// Files that are whole at any time. All functions throw std::runtime_error "<path>: <reason>".
#include <filesystem>
#include <string>
#include <string_view>

namespace hourglass {

/// What a file holds; nothing if there is none.
std::string text_at(const std::filesystem::path& path);

/// One process at a time works in a folder, which is made if need be. Ends with the process, however that ends.
class FolderLock {
 public:
  /// Throws std::invalid_argument if the path is a file or another process has the folder; `what` it does there ("trade") is for the message.
  FolderLock(const std::filesystem::path& folder, const std::string& what);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

/// Replaces the file in one go: written beside it, as <path>.new, then renamed over it.
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Brings a file, or the names in a folder, to the disk: a power cut does not take them back.
void sync_to_disk(const std::filesystem::path& path);

/// Claims room for a later write_atomically() of up to `bytes`, which then succeeds on a full disk too. Holds an
/// empty <path>.new until then.
void reserve_write(const std::filesystem::path& path, std::size_t bytes);

/// Grows by whole pieces: one that does not fit on the disk is taken back before append() throws.
class AppendFile {
 public:
  enum class Start { empty, at_end };
  explicit AppendFile(const std::filesystem::path& path, Start start = Start::empty);
  ~AppendFile();
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;
  void append(std::string_view text);

 private:
  std::filesystem::path path_;
  int descriptor_;
};

/// Claims room for `bytes` after the end of a file, whose size stays, so that a full disk is found before the
/// file is touched. Does nothing on a file system that cannot promise room.
void reserve_room(const std::filesystem::path& path, std::size_t bytes);

}  // namespace hourglass
