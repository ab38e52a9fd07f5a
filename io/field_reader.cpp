#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <string_view>

#include "io/child.hpp"
#include "io/fields_file.hpp"
#include "io/hdf5.hpp"
#include "io/xdmf.hpp"

namespace hourglass {
namespace {

/// The enumerator that goes by this name; the first for an unknown one.
template <class Enum, std::size_t n>
Enum named(const std::string& name, const std::array<const char*, n>& names) {
  return static_cast<Enum>(
      static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()) % n);
}

/// What has been read of a file, by name.
struct Contents {
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, std::vector<std::string>> texts;

  double number(const std::string& name) const { return numbers.at(name).at(0); }
  const std::string& text(const std::string& name) const { return texts.at(name).at(0); }
};

/// One after the other: counts, letters and numbers as they lie in memory.
class Packer {
 public:
  std::string bytes;
  void add(std::size_t count) { append(&count, sizeof count); }
  void add(const std::string& text) {
    add(text.size());
    append(text.data(), text.size());
  }
  void add(const std::vector<double>& values) {
    add(values.size());
    append(values.data(), values.size() * sizeof(double));
  }
  void add(const std::vector<std::string>& texts) {
    add(texts.size());
    for (const std::string& text : texts) add(text);
  }
  template <class Values>
  void add(const std::map<std::string, Values>& named) {
    add(named.size());
    for (const auto& [name, values] : named) {
      add(name);
      add(values);
    }
  }

 private:
  void append(const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }
};

/// The other way round. Throws std::runtime_error at an end that comes too soon.
class Unpacker {
 public:
  explicit Unpacker(const std::string& bytes) : left_(bytes) {}
  void take(std::string& text) { text = next(count()); }
  void take(std::vector<double>& values) {
    const std::size_t n = count();
    const std::string_view data = next(n > left_.size() ? n : n * sizeof(double));
    values.resize(n);
    if (n > 0) std::memcpy(values.data(), data.data(), data.size());
  }
  void take(std::vector<std::string>& texts) {
    for (std::size_t n = count(); n > 0; --n) take(texts.emplace_back());
  }
  template <class Values>
  void take(std::map<std::string, Values>& named) {
    for (std::size_t n = count(); n > 0; --n) {
      std::string name;
      take(name);
      take(named[name]);
    }
  }

 private:
  std::string_view next(std::size_t size) {
    if (size > left_.size()) throw std::runtime_error("is damaged");
    const std::string_view part = left_.substr(0, size);
    left_.remove_prefix(size);
    return part;
  }
  std::size_t count() {
    std::size_t n = 0;
    std::memcpy(&n, next(sizeof n).data(), sizeof n);
    return n;
  }
  std::string_view left_;
};

/// What `read` reads, in a child process that has so many seconds of processor time.
Contents contents_of(const std::filesystem::path& path, const std::function<Contents()>& read,
                     double seconds) {
  try {
    h5::access(path.string());  // starts the library here: a child would have to do so each time
    const auto bytes = from_child(
        [&] {
          const Contents all = read();
          Packer packer;
          packer.add(all.numbers);
          packer.add(all.texts);
          return std::move(packer.bytes);
        },
        seconds);
    if (!bytes)
      throw std::runtime_error(
          "is damaged: the HDF5 library does not survive reading it. Run the scene again.");
    Contents all;
    Unpacker unpacker(*bytes);
    unpacker.take(all.numbers);
    unpacker.take(all.texts);
    return all;
  } catch (const std::runtime_error& error) {
    const std::string what = error.what();
    throw std::runtime_error(what.starts_with(path.string()) ? what
                                                             : fmt::format("{}: {}", path.string(), what));
  }
}

std::string outline_name(int number) { return "solids/" + member_name(number); }

int cell_count(double number) {
  if (!(number >= 1 && number <= 1 << 20)) throw std::runtime_error(fmt::format("{} cells across", number));
  return static_cast<int>(number);
}

/// All but the cells.
Contents about_run(const std::filesystem::path& path) {
  Contents all;
  const h5::Id file = h5::open(path, H5F_ACC_RDONLY);
  if (!h5::has_attribute(file, "format") || h5::read_string(file, "format") != fields_format)
    throw std::runtime_error("not a file of fields by this version of hourglass");
  for (const char* name : {"name", "units", "walls", "materials"})
    all.texts[name] = h5::read_strings(file, name);
  for (const char* name : {"cells", "origin", "spacing"}) all.numbers[name] = h5::read_numbers(file, name);
  for (const char* name : {"symmetry", "coordinates"})
    if (h5::has_attribute(file, name)) all.texts[name] = h5::read_strings(file, name);
  for (const char* name : {"orifices", "slow_speed", "steady"})
    if (h5::has_attribute(file, name)) all.numbers[name] = h5::read_numbers(file, name);
  if (H5Lexists(file, "solids", H5P_DEFAULT) > 0) {
    const h5::Id group = h5::group(file, "solids");
    for (int k = 0; static_cast<hsize_t>(k) < h5::member_count(group); ++k)
      all.numbers[outline_name(k)] = h5::read_dataset(group, member_name(k));
  }
  const h5::Id frames = h5::group(file, "frames");
  std::vector<double>& times = all.numbers["times"];
  for (int k = 0; static_cast<hsize_t>(k) < h5::member_count(frames); ++k) {
    const h5::Id frame = h5::group(frames, member_name(k));
    times.push_back(h5::read_number(frame, "time"));
    all.texts[member_name(k)] = h5::member_names(frame);
    std::erase(all.texts[member_name(k)], "velocity");
  }
  return all;
}

/// The named fields and the velocity.
Contents cells_of_frame(const std::filesystem::path& path, const std::string& frame,
                        const std::vector<std::string>& fields, std::size_t cells) {
  Contents all;
  const h5::Id file = h5::open(path, H5F_ACC_RDONLY), group = h5::group(file, "frames/" + frame);
  for (const std::string& name : fields) all.numbers[name] = h5::read_dataset(group, name, cells);
  all.numbers["velocity"] = h5::read_dataset(group, "velocity", 3 * cells);
  return all;
}

}  // namespace

FieldReader::FieldReader(const std::filesystem::path& run) : h5_(run / "fields.h5") {
  const Contents file = contents_of(
      h5_, [&] { return about_run(h5_); }, 10);
  try {
    info_.name = file.text("name");
    info_.units = named<Units>(file.text("units"), units_names);
    const auto &cells = file.numbers.at("cells"), &origin = file.numbers.at("origin");
    info_.patch = {cell_count(cells.at(0)), cell_count(cells.at(1)), file.number("spacing"), origin.at(0),
                   origin.at(1)};
    if (!(info_.patch.h > 0 && std::isfinite(info_.patch.h)))
      throw std::runtime_error(fmt::format("cells of {}: not a grid", info_.patch.h));
    for (int s = 0; s < 4; ++s) info_.walls[s] = named<Wall>(file.texts.at("walls").at(s), wall_names);
    if (file.numbers.contains("orifices")) {
      const auto& o = file.numbers.at("orifices");
      for (std::size_t k = 0; k + 2 < o.size(); k += 3) {
        if (!(o[k] >= 0 && o[k] < 4)) throw std::runtime_error(fmt::format("orifice in wall {}", o[k]));
        info_.orifices.push_back({static_cast<Side>(int(o[k])), o[k + 1], o[k + 2]});
      }
    }
    info_.materials = file.texts.at("materials");
    if (file.texts.contains("symmetry")) {  // files of earlier versions have none of these
      info_.symmetry = named<Symmetry>(file.text("symmetry"), symmetry_names);
      info_.coordinates = named<Coordinates>(file.text("coordinates"), coordinates_names);
      info_.slow_speed = file.number("slow_speed");
    }
    info_.steady = file.numbers.contains("steady");
    for (int k = 0; file.numbers.contains(outline_name(k)); ++k) {
      const auto& corners = file.numbers.at(outline_name(k));
      Polygon& outline = info_.solids.emplace_back();
      for (std::size_t c = 0; c + 1 < corners.size(); c += 2) outline.push_back({corners[c], corners[c + 1]});
    }
    times_ = file.numbers.at("times");
    for (std::size_t k = 0; k < times_.size(); ++k)
      names_.push_back(file.texts.at(member_name(static_cast<int>(k))));
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: {}", h5_.string(), error.what()));
  }
}

Frame FieldReader::read(int frame, const std::vector<std::string>& fields) const {
  for (const std::string& name : fields)
    if (std::ranges::find(names(frame), name) == names(frame).end())
      throw std::invalid_argument(fmt::format("{}: field '{}' is not stored; stored are: {}", h5_.string(),
                                              name, fmt::join(names(frame), ", ")));
  const Patch& patch = info_.patch;
  const auto cells = static_cast<std::size_t>(patch.cells());
  const double seconds = 10 + 1e-7 * static_cast<double>(cells * (fields.size() + 3));
  const Contents file = contents_of(
      h5_, [&] { return cells_of_frame(h5_, member_name(frame), fields, cells); }, seconds);
  const auto component = [&](const std::string& name, int c, int components) {
    CellField field(patch);
    const std::vector<double>& values = file.numbers.at(name);
    const double* in = values.data() + c;
    if (values.size() != cells * static_cast<std::size_t>(components))
      throw std::runtime_error(fmt::format("{}: {}: wrong extents", h5_.string(), name));
    for (int j = 0; j < patch.ny; ++j) {
      for (int i = 0; i < patch.nx; ++i, in += components) field(i, j) = *in;
    }
    return field;
  };

  Frame out;
  out.t = times_.at(frame);
  for (const std::string& name : fields) out.fields.emplace_back(name, component(name, 0, 1));
  out.velocity_x = component("velocity", 0, 3);
  out.velocity_y = component("velocity", 1, 3);
  return out;
}

std::vector<int> frames_at(const std::vector<double>& all, const std::vector<double>& wanted) {
  std::vector<int> frames;
  for (int k = 0; k < static_cast<int>(all.size()) && wanted.empty(); ++k) frames.push_back(k);
  const double slack = 1e-6 * (all.back() - all.front());
  for (const double t : wanted) {
    if (!(t >= all.front() - slack && t <= all.back() + slack)) {
      throw std::invalid_argument(fmt::format("time {} is outside the run, whose frames go from {} to {}", t,
                                              all.front(), all.back()));
    }
    const auto nearer = [t](double a, double b) { return std::abs(a - t) < std::abs(b - t); };
    frames.push_back(static_cast<int>(std::min_element(all.begin(), all.end(), nearer) - all.begin()));
  }
  return frames;
}

}  // namespace hourglass
