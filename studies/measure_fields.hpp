#pragma once
// Figures of the fields that a run has stored, frame by frame.
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/chart.hpp"
#include "io/xdmf.hpp"
#include "kernels/geometry.hpp"
#include "solver/quasi_static.hpp"
#include "studies/field_point.hpp"
#include "studies/measure.hpp"

namespace hourglass {

/// Mean of the frames in a window of time.
struct FrameMean {
  std::string quantity;
  double value = 0, from = 0, to = 0;
};

class FieldMeasure {
 public:
  /// Reads the options. Throws std::invalid_argument if one is wrong, std::runtime_error if the run has no fields.
  FieldMeasure(const std::filesystem::path& run, const Scene& scene, const MeasureOptions& options);

  /// quasi_static.csv, a row each frame, and its plot; returns the means over the frames between two times, or the last
  /// frame if none is.
  std::vector<FrameMean> quasi_static(double from, double to) const;
  /// profiles.csv and plots; nothing without lines.
  void profiles(double from, double to) const;
  /// probes.csv and plots; nothing without probes.
  void probes() const;

 private:
  struct Line {
    std::string text;                ///< as it was given
    std::vector<FieldPoint> points;  ///< at most a cell apart
    std::vector<double> s;           ///< distance from its begin [L]
  };
  /// Values along a line by field.
  using Values = std::vector<std::vector<double>>;

  Line line_of(const std::string& text) const;
  FieldPoint probe_of(const std::string& text) const;
  std::vector<int> frames_in(double from, double to) const;
  Frame read(int frame) const;
  std::vector<double> values_at(const FieldPoint& point, const Frame& frame) const;
  Values along(const Line& line, const std::vector<int>& frames) const;
  std::string axis_title(const std::string& field) const;
  void draw(const std::string& name, const Chart& chart) const;

  std::filesystem::path run_;
  const Scene& scene_;
  FieldReader reader_;
  std::unique_ptr<Geometry> geometry_;
  std::vector<double> thresholds_;  ///< [sqrt(g d)]
  std::vector<std::string> fields_;
  std::vector<Line> lines_;
  std::vector<std::string> probe_texts_;
  std::vector<FieldPoint> probes_;
  std::vector<int> frames_;  ///< of the profiles; none: the mean
};

/// Of quasi_static.csv and measure.csv: "quasi_static_1e-3".
std::string quasi_static_name(double threshold);

}  // namespace hourglass
