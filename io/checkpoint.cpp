#include "io/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "io/child.hpp"
#include "io/files.hpp"
#include "io/hdf5.hpp"
#include "io/provenance.hpp"
#include "io/run_folder.hpp"
#include "io/scene_yaml.hpp"
#include "io/yaml_tree.hpp"

namespace hourglass {
namespace fs = std::filesystem;
namespace {

constexpr const char* format_name = "hourglass checkpoint 1";

/// Two programs of the same build do the same arithmetic.
std::string build_text() {
  const Provenance p = provenance();
  return fmt::format("revision {}, {}, {}, SIMD width {} bits", p.revision, p.compiler, p.flags, p.simd_bits);
}

// ---- numbers and fields in HDF5 --------------------------------------------------------------------------------

/// Bytes that a state takes, about: fields to the byte, and generously what HDF5 writes about them.
class Size : public Archive {
 public:
  std::size_t bytes = 64 << 10;
  bool restoring() const override { return false; }
  void number(const std::string&, double&) override { bytes += 256; }
  void numbers(const std::string&, std::vector<double>& values) override { bytes += 256 + 8 * values.size(); }
  void texts(const std::string&, std::vector<std::string>& values) override {
    bytes += 8192;
    for (const std::string& text : values) bytes += 64 + text.size();
  }
  void table(const std::string&, int rows, int length, const std::function<double*(int)>&) override {
    bytes += 2048 + sizeof(double) * static_cast<std::size_t>(rows) * static_cast<std::size_t>(length);
  }
};

/// In an open file, by handles that outlive it.
class Hdf5Archive : public Archive {
 public:
  explicit Hdf5Archive(hid_t group) : group_(group) {}

 protected:
  hid_t group_;
  std::vector<double> packed_;
};

class Storing final : public Hdf5Archive {
 public:
  using Hdf5Archive::Hdf5Archive;
  bool restoring() const override { return false; }
  void number(const std::string& name, double& value) override {
    h5::write_attribute(group_, prefixed(name), value);
  }
  void numbers(const std::string& name, std::vector<double>& values) override {
    h5::write_attribute(group_, prefixed(name), values, {values.size()});
  }
  void texts(const std::string& name, std::vector<std::string>& values) override {
    h5::write_attribute(group_, prefixed(name), values);
  }
  void table(const std::string& name, int rows, int length, const std::function<double*(int)>& row) override {
    const std::string full = prefixed(name);
    packed_.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(length));
    for (int k = 0; k < rows; ++k) std::copy_n(row(k), length, packed_.begin() + std::ptrdiff_t{k} * length);
    const h5::Id shape = h5::space({static_cast<hsize_t>(rows), static_cast<hsize_t>(length)});
    h5::Id set(H5Dcreate2(group_, full.c_str(), H5T_IEEE_F64LE, shape, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
               H5Dclose, full);
    if (rows > 0)
      h5::checked(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed_.data()), full);
    set.close(full);
  }
};

class Restoring final : public Hdf5Archive {
 public:
  explicit Restoring(const fs::path& path)
      : Hdf5Archive(0), file_(h5::open(path, H5F_ACC_RDONLY)), state_(h5::group(file_, "state")) {
    group_ = state_;
  }
  hid_t file() const { return file_; }
  /// Throws if what there is cannot even be named: then read_through() has not been far.
  void list() const {
    for (const hid_t group : {hid_t{file_}, group_}) h5::attribute_names(group);
    h5::member_names(group_);
  }
  /// Reads all there is, whatever of it cannot be read, as numbers and as texts: nothing else is read later.
  void read_through() const {
    const auto attempt = [](const auto& read) {
      try {
        read();
      } catch (const std::exception&) {
      }
    };
    for (const hid_t group : {hid_t{file_}, group_})
      for (const std::string& name : h5::attribute_names(group)) {
        attempt([&] { h5::read_strings(group, name); });
        attempt([&] { h5::read_numbers(group, name); });
      }
    for (const std::string& name : h5::member_names(group_)) attempt([&] { h5::read_dataset(group_, name); });
  }
  bool restoring() const override { return true; }
  void number(const std::string& name, double& value) override {
    value = h5::read_number(group_, prefixed(name));
  }
  void numbers(const std::string& name, std::vector<double>& values) override {
    values = h5::read_numbers(group_, prefixed(name));
  }
  void texts(const std::string& name, std::vector<std::string>& values) override {
    values = h5::read_strings(group_, prefixed(name));
  }
  void table(const std::string& name, int rows, int length, const std::function<double*(int)>& row) override {
    const std::string full = prefixed(name);
    const h5::Id set(H5Dopen2(group_, full.c_str(), H5P_DEFAULT), H5Dclose, full);
    const h5::Id shape(H5Dget_space(set), H5Sclose, full);
    packed_.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(length));
    if (h5::checked(H5Sget_simple_extent_npoints(shape), full) != static_cast<hssize_t>(packed_.size()))
      throw std::runtime_error(full + ": other extents than the scene's");
    if (rows > 0)
      h5::checked(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed_.data()), full);
    for (int k = 0; k < rows; ++k) std::copy_n(packed_.begin() + std::ptrdiff_t{k} * length, length, row(k));
  }

 private:
  h5::Id file_, state_;
};

// ---- the checksum behind the file ------------------------------------------------------------------------------

/// Of the first `bytes` of a file: a word at a time, in the manner of Fowler, Noll and Vo's hash.
std::string seal_of(const fs::path& path, std::size_t bytes) {
  std::ifstream in(path, std::ios::binary);
  std::vector<char> block(std::min<std::size_t>(bytes, 1 << 20));
  std::uint64_t hash = 0xcbf29ce484222325;
  while (bytes > 0 && in) {
    const std::size_t n = std::min(bytes, block.size());
    in.read(block.data(), static_cast<std::streamsize>(n));
    for (std::size_t k = 0; k < n; k += sizeof hash) {
      std::uint64_t word = 0;
      std::memcpy(&word, block.data() + k, std::min(sizeof word, n - k));
      hash = (hash ^ word) * 0x100000001b3;
      hash ^= hash >> 32;
    }
    bytes -= n;
  }
  if (!in) throw std::runtime_error(path.string() + ": cannot be read");
  return fmt::format("checksum{:016x}", hash);
}

bool is_whole(const fs::path& path) {
  const std::size_t size = fs::file_size(path);
  if (size < seal_length) return false;
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(size - seal_length));
  std::string seal(seal_length, '\0');
  in.read(seal.data(), seal_length);
  return in && seal == seal_of(path, size - seal_length);
}

// ---- whether it fits -------------------------------------------------------------------------------------------

struct Difference {
  std::string path, here, there;
};

std::string value_text(const YamlNode* node) {
  return !node ? "missing" : node->kind == YamlNode::Kind::scalar ? node->text : what_is(*node);
}

std::optional<Difference> first_difference(const YamlNode* here, const YamlNode* there,
                                           const std::string& path) {
  if (std::ranges::find(changeable_keys, path) != changeable_keys.end()) return std::nullopt;
  if (!here || !there || here->kind != there->kind || here->text != there->text)
    return Difference{path, value_text(here), value_text(there)};
  const auto below = [&](const std::string& key) {
    return first_difference(here->find(key), there->find(key), path.empty() ? key : path + "." + key);
  };
  for (const YamlNode* one : {here, there}) {
    for (const auto& [key, value] : one->keys)
      if (auto found = below(key)) return found;
    for (std::size_t k = 0; k < one->items.size(); ++k)
      if (auto found = below(fmt::format("{}", k))) return found;
  }
  return std::nullopt;
}

/// Throws std::invalid_argument unless the run in the folder is one of this scene.
void check_same_scene(const fs::path& folder, const std::string& stored, const Scene& scene) {
  const YamlNode here = parse_yaml(to_yaml(scene)), there = parse_yaml(stored);
  const auto difference = first_difference(&here, &there, "");
  if (!difference) return;
  throw std::invalid_argument(fmt::format(
      "{}: holds a run of another scene: {} is {} there, {} here. Resume it with its own value (only {} may "
      "change), choose another folder with --out, or replace the run with --force.",
      folder.string(), difference->path, difference->there, difference->here,
      fmt::join(changeable_keys, ", ")));
}

/// Throws std::invalid_argument if the checkpoint is whole, but not of this scene or version.
Checkpoint opened(const fs::path& path, const Scene& scene, std::vector<std::string>& words) {
  // Its checksum can be made up, and damaged files make the HDF5 library itself crash: a child tries first.
  if (!survives([&] { Restoring(path).read_through(); }))
    throw std::invalid_argument(fmt::format(
        "{}: the HDF5 library does not survive reading it. Run again from the start with --force.",
        path.string()));
  auto state = std::make_unique<Restoring>(path);
  state->list();
  const Provenance p = provenance();
  const std::string format = h5::read_string(state->file(), "format"),
                    version = h5::read_string(state->file(), "version");
  if (format != format_name || version != p.version)
    throw std::invalid_argument(
        fmt::format("{}: written by hourglass {} ({}), this is {} ({}). Resume the run with the program that "
                    "began it, or "
                    "replace it with --force.",
                    path.string(), version, format, p.version, format_name));
  check_same_scene(path.parent_path(), h5::read_string(state->file(), "scene"), scene);
  if (const std::string build = h5::read_string(state->file(), "build"); build != build_text())
    words.push_back(
        fmt::format("{}: written by another build ({}): the run goes on, but not to the last bit as "
                    "without a break",
                    path.string(), build));
  const double t = h5::read_number(state->file(), "time"), step = h5::read_number(state->file(), "step");
  if (!std::isfinite(t) || !(step >= 0 && step < 1e15))
    throw std::invalid_argument(
        fmt::format("{}: t = {}, step {}: no run was ever there. Run again from the start with --force.",
                    path.string(), t, step));
  return {std::move(state), t, static_cast<long>(step)};
}

std::optional<Checkpoint> newest(const fs::path& folder, const Scene& scene,
                                 std::vector<std::string>& words) {
  std::vector<std::string> damaged;
  for (const char* name : {checkpoint_name, previous_checkpoint_name}) {
    const fs::path path = folder / name;
    if (!fs::is_regular_file(path)) continue;
    if (!is_whole(path)) {
      damaged.push_back(name);
      continue;
    }
    if (!damaged.empty())
      words.push_back(
          fmt::format("{}: damaged; going on from {}, which is older", (folder / damaged[0]).string(), name));
    return opened(path, scene, words);
  }
  if (damaged.empty()) return std::nullopt;
  throw std::invalid_argument(fmt::format("{}: {} damaged. Run again from the start with --force.",
                                          folder.string(), fmt::join(damaged, " and ")));
}

}  // namespace

void seal(const fs::path& path) {
  AppendFile(path, AppendFile::Start::at_end).append(seal_of(path, fs::file_size(path)));
}

void write_checkpoint(const fs::path& folder, const Scene& scene, double t, long step, const Walk& walk) {
  const fs::path path = folder / checkpoint_name, beside = path.string() + ".new";
  Size size;
  walk(size);
  try {
    h5::create(beside).close("create");
    reserve_room(beside, size.bytes);
    h5::Id file = h5::open(beside, H5F_ACC_RDWR);
    h5::write_attribute(file, "format", std::string(format_name));
    h5::write_attribute(file, "version", provenance().version);
    h5::write_attribute(file, "build", build_text());
    h5::write_attribute(file, "scene", to_yaml(scene));
    h5::write_attribute(file, "time", t);
    h5::write_attribute(file, "step", static_cast<double>(step));
    {
      const h5::Id state(H5Gcreate2(file, "state", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "state");
      Storing archive(state);
      walk(archive);
    }
    file.close("close");
    seal(beside);
    sync_to_disk(beside);
  } catch (const std::runtime_error& error) {
    std::error_code ignored;
    fs::remove(beside, ignored);
    throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
  }
  if (fs::exists(path)) fs::rename(path, folder / previous_checkpoint_name);
  fs::rename(beside, path);
  sync_to_disk(folder);
}

Resumption resume(const fs::path& folder, const Scene& scene) {
  Resumption found;
  if (!holds_run(folder)) return found;  // with nothing of a run in it: from the start
  found.from = newest(folder, scene, found.words);
  if (const std::string stored = text_at(folder / "scene.yaml"); !found.from && !stored.empty())
    check_same_scene(folder, stored, scene);
  const std::string status = status_of_run(folder);
  if (status == name_of(Status::stopped) || status == name_of(Status::finished)) {
    const TimeControl& time = scene.time;
    const bool more = found.from && status == name_of(Status::finished) &&
                      !(time.end > 0 && found.from->t >= time.end) &&
                      !(time.max_steps > 0 && found.from->step >= time.max_steps);
    found.done = !more;
    if (found.done)
      found.words = {fmt::format("{}: the run is at its end ({}){}; nothing is left to do", folder.string(),
                                 status, found.from ? "" : " and holds no checkpoint to go on from")};
  }
  if (!found.from && !found.done)
    found.words.push_back(fmt::format("{}: holds no checkpoint yet; the run begins again", folder.string()));
  return found;
}

}  // namespace hourglass
