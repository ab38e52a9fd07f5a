#pragma once
// fields.h5 and fields.xdmf: the fields of a run over time, for ParaView (XDMF 3) and h5py.
//
// fields.h5, all numbers in the run's units:
//   /                          attributes format, name, units (grain | SI), cells [nx, ny], origin [x, y],
//                              spacing, walls [left, right, bottom, top], orifices [n][side, centre, width],
//                              materials, symmetry, coordinates, slow_speed; steady, if it is of a model in
//                              closed form
//   /solids/000000             float64 [corners][2], one outline each
//   /frames/000012             attribute time
//   /frames/000012/speed       float32 [ny][nx], cell data, row 0 at the bottom; attributes name, units,
//                              location ("cell"), time
//   /frames/000012/velocity    float32 [ny][nx][3]
//
// fields.xdmf shows the plane as a slab one cell thick around z = 0.
//
// The file is closed between frames, and fields.xdmf is replaced after it: a run that is killed leaves both
// readable up to the last frame. All failures are std::runtime_error "<path>: <reason>"; earlier frames stay.
#include <filesystem>
#include <string>
#include <vector>

#include "io/frame.hpp"

namespace hourglass {

class FieldWriter {
 public:
  /// Makes `folder`/fields.h5 anew. deflate: compression level 0 (none) to 9.
  FieldWriter(const std::filesystem::path& folder, const RunInfo& info, int deflate = 0);
  /// Goes on behind the first `frames` frames of `folder`/fields.h5, of these fields; later ones go. Throws
  /// std::runtime_error if there are fewer.
  FieldWriter(const std::filesystem::path& folder, const RunInfo& info,
              const std::vector<std::string>& fields, int frames, int deflate = 0);
  void write(const Frame& frame);
  int frames() const { return frames_; }  ///< written so far

 private:
  void write_xdmf() const;

  std::filesystem::path h5_, xdmf_;
  RunInfo info_;
  int deflate_;
  int frames_ = 0;
  std::string grids_;  ///< the <Grid> of every frame
};

/// Damaged files make the HDF5 library crash, go round in circles, or write where it should not: all reading is done by a
/// child process, which sends what it has read. So nothing that is in a file harms the reader's own process.
class FieldReader {
 public:
  /// `run`: a run folder. Throws std::runtime_error if it holds no fields.h5 or one of another kind.
  explicit FieldReader(const std::filesystem::path& run);

  const RunInfo& info() const { return info_; }
  const std::vector<double>& times() const { return times_; }  ///< by frame, rising
  /// Names of the scalar fields of a frame.
  const std::vector<std::string>& names(int frame) const { return names_.at(frame); }
  /// The named fields and the velocity. Throws std::invalid_argument for a field that is not stored.
  Frame read(int frame, const std::vector<std::string>& fields) const;

 private:
  std::filesystem::path h5_;
  RunInfo info_;
  std::vector<double> times_;
  std::vector<std::vector<std::string>> names_;  ///< by frame
};

/// The frame nearest to each of the wanted times; all frames if none is wanted. Throws std::invalid_argument for a time
/// outside of the run.
std::vector<int> frames_at(const std::vector<double>& times, const std::vector<double>& wanted);

}  // namespace hourglass
