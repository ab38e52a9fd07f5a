#include "io/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace hourglass {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int error) {
  throw std::runtime_error(fmt::format("{}: {}", path.string(), std::strerror(error)));
}

class Descriptor {
 public:
  /// Errors name `named`.
  Descriptor(const std::filesystem::path& path, int flags, const std::filesystem::path& named)
      : named_(named), fd_(::open(path.c_str(), flags, 0666)) {
    if (fd_ < 0) fail(named, errno);
  }
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  /// Network file systems report a full disk only here.
  void close() {
    if (::close(std::exchange(fd_, -1)) != 0) fail(named_, errno);
  }
  operator int() const { return fd_; }

 private:
  const std::filesystem::path& named_;
  int fd_;
};

/// 0 or the errno.
int write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    bytes.remove_prefix(n);
  }
  return 0;
}

std::filesystem::path beside_of(const std::filesystem::path& path) { return path.string() + ".new"; }

}  // namespace

std::string text_at(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return {};
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path.string() + ": cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& what) {
  std::error_code error;
  if (std::filesystem::is_regular_file(folder, error))
    throw std::invalid_argument(
        fmt::format("{}: is a file; choose another folder with --out", folder.string()));
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(fmt::format("{}: {}", folder.string(), error.message()));
  descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0) fail(folder, errno);
  // A file system without locks (some network drives) has none to respect.
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw std::invalid_argument(
      fmt::format("{}: another {} is at work in it. Wait for its end, or choose another folder with --out.",
                  folder.string(), what));
}
FolderLock::~FolderLock() { ::close(descriptor_); }

void write_atomically(const std::filesystem::path& path, std::string_view bytes) {
  const std::filesystem::path beside = beside_of(path);
  try {
    Descriptor file(beside, O_WRONLY | O_CREAT | O_CLOEXEC, path);  // not cut: it may hold reserved room
    if (const int error = write_all(file, bytes)) fail(path, error);
    if (::ftruncate(file, static_cast<off_t>(bytes.size())) != 0) fail(path, errno);
    file.close();
  } catch (...) {
    ::unlink(beside.c_str());
    throw;
  }
  if (::rename(beside.c_str(), path.c_str()) != 0) fail(path, errno);
}

void sync_to_disk(const std::filesystem::path& path) {
  const Descriptor file(path, O_RDONLY | O_CLOEXEC, path);
  if (::fsync(file) != 0 && errno != EINVAL) fail(path, errno);  // EINVAL: not a thing to bring to a disk
}

void reserve_write(const std::filesystem::path& path, std::size_t bytes) {
  const std::filesystem::path beside = beside_of(path);
  Descriptor(beside, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, path).close();
  reserve_room(beside, bytes);
}

AppendFile::AppendFile(const std::filesystem::path& path, Start start)
    : path_(path),
      descriptor_(::open(path.c_str(),
                         O_WRONLY | O_CREAT | (start == Start::empty ? O_TRUNC : 0) | O_APPEND | O_CLOEXEC,
                         0666)) {
  if (descriptor_ < 0) fail(path, errno);
}

AppendFile::~AppendFile() { ::close(descriptor_); }

void AppendFile::append(std::string_view text) {
  const off_t whole = ::lseek(descriptor_, 0, SEEK_END);
  if (const int error = write_all(descriptor_, text)) {
    if (::ftruncate(descriptor_, whole) != 0) fail(path_, errno);
    fail(path_, error);
  }
}

void reserve_room(const std::filesystem::path& path, std::size_t bytes) {
  Descriptor file(path, O_WRONLY | O_CLOEXEC, path);
  const off_t end = ::lseek(file, 0, SEEK_END);
  if (::fallocate(file, FALLOC_FL_KEEP_SIZE, end, static_cast<off_t>(bytes)) != 0 && errno != EOPNOTSUPP &&
      errno != ENOSYS) {
    fail(path, errno);
  }
}

}  // namespace hourglass
