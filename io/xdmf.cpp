#include "io/xdmf.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/fields_file.hpp"
#include "io/files.hpp"
#include "io/hdf5.hpp"
#include "io/html.hpp"

namespace hourglass {
namespace {

/// HDF5 writes a new length into the file before the file has it, and opens none that is shorter than it says: a kill in
/// between would cost all frames. Longer is no matter; the next flush cuts off what is too much.
void make_longer(const std::filesystem::path& path, std::size_t bytes) {
  std::error_code error;
  std::filesystem::resize_file(path, std::filesystem::file_size(path) + bytes, error);
  if (error) throw std::runtime_error(error.message());
}

/// A name in an attribute, where XML has no control characters.
std::string xml(const std::string& text) {
  std::string out = html_text(text);
  std::ranges::replace_if(
      out, [](unsigned char c) { return c < 0x20; }, ' ');
  return out;
}

/// One dataset of cell data with as many components as there are fields, padded with zeros to `components`.
void write_cells(hid_t group, const std::string& name, const std::string& unit, double t,
                 const std::vector<const CellField*>& fields, int components, int deflate) {
  const Patch& patch = fields[0]->patch();
  std::vector<float> values(patch.cells() * components);
  for (int c = 0; c < static_cast<int>(fields.size()); ++c) {
    float* out = values.data() + c;
    for (int j = 0; j < patch.ny; ++j) {
      for (int i = 0; i < patch.nx; ++i, out += components) *out = static_cast<float>((*fields[c])(i, j));
    }
  }
  std::vector<hsize_t> extents{static_cast<hsize_t>(patch.ny), static_cast<hsize_t>(patch.nx)};
  if (components > 1) extents.push_back(components);

  const h5::Id shape = h5::space(extents);
  const h5::Id layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
  if (deflate > 0) {  // in slices of rows, about 1 MiB each
    const hsize_t row_bytes = static_cast<hsize_t>(patch.nx) * components * sizeof(float);
    std::vector<hsize_t> slice = extents;
    slice[0] = std::clamp<hsize_t>((hsize_t{1} << 20) / row_bytes, 1, extents[0]);
    h5::checked(H5Pset_chunk(layout, static_cast<int>(slice.size()), slice.data()), name);
    h5::checked(H5Pset_shuffle(layout), name);
    h5::checked(H5Pset_deflate(layout, deflate), name);
  }
  h5::Id set(H5Dcreate2(group, name.c_str(), H5T_IEEE_F32LE, shape, H5P_DEFAULT, layout, H5P_DEFAULT),
             H5Dclose, name);
  h5::checked(H5Dwrite(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), name);
  h5::write_attribute(set, "name", name);
  h5::write_attribute(set, "units", unit);
  h5::write_attribute(set, "location", std::string("cell"));
  h5::write_attribute(set, "time", t);
  set.close(name);
}

void write_outlines(hid_t file, const std::vector<Polygon>& outlines) {
  const h5::Id group = h5::create_compact_group(file, "solids", static_cast<unsigned>(outlines.size()), 6);
  for (std::size_t k = 0; k < outlines.size(); ++k) {
    const std::string name = member_name(static_cast<int>(k));
    const h5::Id shape = h5::space({outlines[k].size(), 2});
    h5::Id set(H5Dcreate2(group, name.c_str(), H5T_IEEE_F64LE, shape, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
               H5Dclose, name);
    h5::checked(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, outlines[k].data()), name);
    set.close(name);
  }
}

// The plane is written as a slab one cell thick: ParaView's three XDMF readers agree on it, while all of them
// lay a 2DCoRectMesh into the y-z plane, across its own velocities.
std::string xdmf_attribute(const std::string& frame, const std::string& name, const Patch& p,
                           int components) {
  return fmt::format(
      "        <Attribute Name=\"{0}\" AttributeType=\"{1}\" Center=\"Cell\">\n"
      "          <DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"4\" Dimensions=\"1 {2} {3}{4}\">"
      "fields.h5:/frames/{5}/{0}</DataItem>\n"
      "        </Attribute>\n",
      name, components > 1 ? "Vector" : "Scalar", p.ny, p.nx,
      components > 1 ? fmt::format(" {}", components) : "", frame);
}

std::string xdmf_grid(const std::string& frame, const RunInfo& info, double t,
                      const std::vector<std::string>& fields) {
  const Patch& p = info.patch;
  std::string out = fmt::format(  // z, y, x: slowest index first
      "      <Grid Name=\"{0}\" GridType=\"Uniform\">\n"
      "        <Time Value=\"{1}\"/>\n"
      "        <Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"2 {2} {3}\"/>\n"
      "        <Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n"
      "          <DataItem Format=\"XML\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"3\">{4} {5} "
      "{6}</DataItem>\n"
      "          <DataItem Format=\"XML\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"3\">{7} {7} "
      "{7}</DataItem>\n"
      "        </Geometry>\n",
      xml(info.name), t, p.ny + 1, p.nx + 1, -p.h / 2, p.y0, p.x0, p.h);
  for (const std::string& name : fields) out += xdmf_attribute(frame, name, p, 1);
  out += xdmf_attribute(frame, "velocity", p, 3);
  return out + "      </Grid>\n";
}

}  // namespace

FieldWriter::FieldWriter(const std::filesystem::path& folder, const RunInfo& info, int deflate)
    : h5_(folder / "fields.h5"), xdmf_(folder / "fields.xdmf"), info_(info), deflate_(deflate) {
  const Patch& p = info.patch;
  h5::Id file = h5::create(h5_);
  try {
    h5::write_attribute(file, "format", std::string(fields_format));
    h5::write_attribute(file, "name", info.name);
    h5::write_attribute(file, "units", std::string(units_names[static_cast<int>(info.units)]));
    h5::write_attribute(file, "cells", {double(p.nx), double(p.ny)}, {2});
    h5::write_attribute(file, "origin", {p.x0, p.y0}, {2});
    h5::write_attribute(file, "spacing", p.h);
    std::vector<std::string> walls;
    for (const Wall wall : info.walls) walls.push_back(wall_names[static_cast<int>(wall)]);
    h5::write_attribute(file, "walls", walls);
    std::vector<double> orifices;
    for (const Orifice& o : info.orifices) {
      orifices.insert(orifices.end(), {static_cast<double>(o.wall), o.centre, o.width});
    }
    if (!orifices.empty()) h5::write_attribute(file, "orifices", orifices, {info.orifices.size(), 3});
    h5::write_attribute(file, "materials", info.materials);
    h5::write_attribute(file, "symmetry", std::string(symmetry_names[static_cast<int>(info.symmetry)]));
    h5::write_attribute(file, "coordinates",
                        std::string(coordinates_names[static_cast<int>(info.coordinates)]));
    h5::write_attribute(file, "slow_speed", info.slow_speed);
    if (info.steady) h5::write_attribute(file, "steady", 1.0);
    if (!info.solids.empty()) write_outlines(file, info.solids);
    h5::create_compact_group(file, "frames", 1000, 6);
    file.close("close");
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", h5_.string(), error.what()));
  }
}

FieldWriter::FieldWriter(const std::filesystem::path& folder, const RunInfo& info,
                         const std::vector<std::string>& fields, int frames, int deflate)
    : h5_(folder / "fields.h5"), xdmf_(folder / "fields.xdmf"), info_(info), deflate_(deflate),
      frames_(frames) {
  try {
    int stored = 0;
    {
      const h5::Id file = h5::open(h5_, H5F_ACC_RDONLY), all = h5::group(file, "frames");
      stored = static_cast<int>(h5::member_count(all));
      if (stored < frames)
        throw std::runtime_error(fmt::format("holds {} frames, and must hold {}", stored, frames));
      for (int k = 0; k < frames; ++k) {
        const std::string name = member_name(k);
        grids_ += xdmf_grid(name, info_, h5::read_number(h5::group(all, name), "time"), fields);
      }
    }
    if (stored > frames) {  // in a copy: HDF5 cuts off the end of a file before it notes the new length in it
      const std::filesystem::path beside = h5_.string() + ".new";
      std::filesystem::copy_file(h5_, beside, std::filesystem::copy_options::overwrite_existing);
      h5::Id file = h5::open(beside, H5F_ACC_RDWR);
      {
        const h5::Id all = h5::group(file, "frames");
        for (int k = stored - 1; k >= frames; --k)
          h5::checked(H5Ldelete(all, member_name(k).c_str(), H5P_DEFAULT), "frame " + member_name(k));
      }
      file.close("close");
      std::filesystem::rename(beside, h5_);
    }
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", h5_.string(), error.what()));
  }
  write_xdmf();
}

void FieldWriter::write(const Frame& frame) {
  const std::string name = member_name(frames_);
  const std::size_t sets = frame.fields.size() + 1, components = frame.fields.size() + 3;
  // Raw data and, generously, what HDF5 writes about each dataset.
  const std::size_t room = info_.patch.cells() * components * sizeof(float) + (sets + 4) * 8192;
  reserve_room(h5_, room);
  try {
    make_longer(h5_, room);
    h5::Id file = h5::open(h5_, H5F_ACC_RDWR);
    const h5::Id group = h5::create_nameless_group(file);
    h5::write_attribute(group, "time", frame.t);
    for (const auto& [field, values] : frame.fields) {
      write_cells(group, field, unit_text(field_info(field).dimension, info_.units), frame.t, {&values}, 1,
                  deflate_);
    }
    write_cells(group, "velocity", unit_text("L/T", info_.units), frame.t,
                {&frame.velocity_x, &frame.velocity_y}, 3, deflate_);
    // So far nothing that was in the file has changed but its recorded length. The name, which makes the frame
    // part of the file, is one write more: a run killed at any moment leaves a whole file.
    h5::checked(H5Fflush(file, H5F_SCOPE_GLOBAL), "flush");
    make_longer(h5_, 8192);
    h5::link(group, h5::group(file, "frames"), name);
    file.close("close");
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: frame {}: {}", h5_.string(), name, error.what()));
  }
  std::vector<std::string> fields;
  for (const auto& [field, values] : frame.fields) fields.push_back(field);
  grids_ += xdmf_grid(name, info_, frame.t, fields);
  write_xdmf();
  ++frames_;
}

void FieldWriter::write_xdmf() const {
  write_atomically(xdmf_,
                   fmt::format("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
                               "<Xdmf Version=\"3.0\">\n"
                               "  <Domain>\n"
                               "    <Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n"
                               "{}"
                               "    </Grid>\n"
                               "  </Domain>\n"
                               "</Xdmf>\n",
                               xml(info_.name), grids_));
}

}  // namespace hourglass
