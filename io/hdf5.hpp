#pragma once
// RAII over the HDF5 C API: handles that close themselves, failures that throw with HDF5's own reason.
#include <fmt/format.h>
#include <hdf5.h>

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hourglass::h5 {

/// The innermost entry of HDF5's error stack, with the system's reason if it holds one.
inline std::string reason() {
  std::string text = "unknown HDF5 error";
  const auto keep = [](unsigned n, const H5E_error2_t* entry, void* out) -> herr_t {
    if (n == 0) *static_cast<std::string*>(out) = entry->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep, &text);
  const std::string mark = "error message = '";
  if (const auto begin = text.find(mark); begin != std::string::npos) {
    return text.substr(begin + mark.size(), text.find('\'', begin + mark.size()) - begin - mark.size());
  }
  return text;
}

template <class T>
T checked(T result, const std::string& where) {
  if (result < 0) throw std::runtime_error(fmt::format("{}: {}", where, reason()));
  return result;
}

/// A handle; `where` begins the message if it is invalid.
class Id {
 public:
  Id(hid_t id, herr_t (*closer)(hid_t), const std::string& where) : id_(checked(id, where)), close_(closer) {}
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Id& operator=(Id&&) = delete;
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  /// Closes now; unlike the destructor it tells of a failure to write what was pending.
  void close(const std::string& where) { checked(close_(std::exchange(id_, -1)), where); }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Without file locks (a viewer that holds the file open must not stop a run, nor a run a viewer), with whatever
/// is open in a file closed along with it, and without spare blocks at the end of the file, which closing would
/// cut off. The file format is HDF5's oldest: newer ones mark a file whose writer was killed as unreadable.
inline Id access(const std::string& where) {
  // Everything is closed by its handle; a file that could not be closed, its disk being full, would crash
  // HDF5's own cleaning up at exit.
  [[maybe_unused]] static const herr_t no_cleaning_up = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are thrown, not printed
  Id list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, where);
  checked(H5Pset_file_locking(list, false, true), where);
  checked(H5Pset_fclose_degree(list, H5F_CLOSE_STRONG), where);
  checked(H5Pset_meta_block_size(list, 0), where);
  checked(H5Pset_small_data_block_size(list, 0), where);
  return list;
}

inline Id create(const std::filesystem::path& path) {
  const std::string name = path.string();
  const Id list = access(name);
  return {H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, list), H5Fclose, name};
}

inline Id open(const std::filesystem::path& path, unsigned mode) {
  const std::string name = path.string();
  const Id list = access(name);
  return {H5Fopen(name.c_str(), mode, list), H5Fclose, name};
}

inline Id group(hid_t parent, const std::string& name) {
  return {H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, "group " + name};
}

inline hsize_t member_count(hid_t group) {
  H5G_info_t about;
  checked(H5Gget_info(group, &about), "group");
  return about.nlinks;
}

/// For HDF5's iterations: adds the name that they come to.
template <class About>
herr_t keep_name(hid_t, const char* name, const About*, void* names) {
  static_cast<std::vector<std::string>*>(names)->push_back(name);
  return 0;
}

inline std::vector<std::string> member_names(hid_t group) {
  std::vector<std::string> names;
  checked(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep_name<H5L_info_t>, &names), "group");
  return names;
}

inline std::vector<std::string> attribute_names(hid_t object) {
  std::vector<std::string> names;
  checked(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep_name<H5A_info_t>, &names),
          "attributes");
  return names;
}

/// A group whose own header lists its members, with room for `members` names of `name_length` letters: adding
/// one of these changes a few bytes in one place of the file.
inline Id create_compact_group(hid_t parent, const std::string& name, unsigned members,
                               unsigned name_length) {
  const std::string where = "group " + name;
  const Id list(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, where);
  checked(H5Pset_link_creation_order(list, H5P_CRT_ORDER_TRACKED), where);  // or the list goes to a B-tree
  checked(H5Pset_link_phase_change(list, 65535, 0), where);
  checked(H5Pset_est_link_info(list, members, name_length), where);
  return {H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, list, H5P_DEFAULT), H5Gclose, where};
}

/// A group that nobody sees before link() gives it a name.
inline Id create_nameless_group(hid_t file) {
  return {H5Gcreate_anon(file, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "new group"};
}

inline void link(hid_t object, hid_t parent, const std::string& name) {
  checked(H5Olink(object, parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT), "link " + name);
}

inline Id string_type() {
  Id type(H5Tcopy(H5T_C_S1), H5Tclose, "string type");
  checked(H5Tset_size(type, H5T_VARIABLE), "string type");
  checked(H5Tset_cset(type, H5T_CSET_UTF8), "string type");
  return type;
}

/// No extents: a scalar. An extent may be 0; HDF5 then wants no data, not even a place for it.
inline Id space(const std::vector<hsize_t>& extents) {
  return {extents.empty() ? H5Screate(H5S_SCALAR)
                          : H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr),
          H5Sclose, "dataspace"};
}

inline void write_attribute(hid_t object, const std::string& name, hid_t type, const void* data,
                            const std::vector<hsize_t>& extents) {
  const std::string where = "attribute " + name;
  const Id shape = space(extents);
  const Id attribute(H5Acreate2(object, name.c_str(), type, shape, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                     where);
  if (data) checked(H5Awrite(attribute, type, data), where);
}

inline void write_attribute(hid_t object, const std::string& name, double value) {
  write_attribute(object, name, H5T_NATIVE_DOUBLE, &value, {});
}
inline void write_attribute(hid_t object, const std::string& name, const std::vector<double>& values,
                            const std::vector<hsize_t>& extents) {
  write_attribute(object, name, H5T_NATIVE_DOUBLE, values.data(), extents);
}
inline void write_attribute(hid_t object, const std::string& name, const std::string& value) {
  const char* text = value.c_str();
  write_attribute(object, name, string_type(), &text, {});
}
inline void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& values) {
  std::vector<const char*> texts;
  for (const std::string& value : values) texts.push_back(value.c_str());
  write_attribute(object, name, string_type(), texts.data(), {texts.size()});
}

inline bool has_attribute(hid_t object, const std::string& name) {
  return H5Aexists(object, name.c_str()) > 0;
}

/// Numbers in storage order; a scalar gives one.
inline std::vector<double> read_numbers(hid_t object, const std::string& name) {
  const std::string where = "attribute " + name;
  const Id attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, where);
  const Id shape(H5Aget_space(attribute), H5Sclose, where);
  std::vector<double> values(checked(H5Sget_simple_extent_npoints(shape), where));
  if (!values.empty()) checked(H5Aread(attribute, H5T_NATIVE_DOUBLE, values.data()), where);
  return values;
}
inline double read_number(hid_t object, const std::string& name) { return read_numbers(object, name).at(0); }

/// All numbers of a dataset, in storage order. `wanted`: how many there must be, if that is known; nothing is read else.
inline std::vector<double> read_dataset(hid_t group, const std::string& name,
                                        std::optional<std::size_t> wanted = {}) {
  const Id set(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, name);
  const Id shape(H5Dget_space(set), H5Sclose, name);
  const auto size = static_cast<std::size_t>(checked(H5Sget_simple_extent_npoints(shape), name));
  if (wanted && size != *wanted) throw std::runtime_error(name + ": wrong extents");
  std::vector<double> values(size);
  if (size > 0) checked(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), name);
  return values;
}

inline std::vector<std::string> read_strings(hid_t object, const std::string& name) {
  const std::string where = "attribute " + name;
  const Id attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, where);
  const Id shape(H5Aget_space(attribute), H5Sclose, where);
  const Id type = string_type();
  std::vector<char*> texts(checked(H5Sget_simple_extent_npoints(shape), where));
  if (texts.empty()) return {};
  checked(H5Aread(attribute, type, texts.data()), where);
  std::vector<std::string> values(texts.begin(), texts.end());
  H5Dvlen_reclaim(type, shape, H5P_DEFAULT, texts.data());
  return values;
}
inline std::string read_string(hid_t object, const std::string& name) {
  return read_strings(object, name).at(0);
}

}  // namespace hourglass::h5
