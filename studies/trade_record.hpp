#pragma once
// What a trade compares runs by: quantities that do not depend on the grid, and how far two of them are apart.
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "studies/case.hpp"
#include "studies/richardson.hpp"

namespace hourglass {

struct Quantity {
  const char* key;
  const char* title;
  const char* error;  ///< how it is measured
  bool
      relative;  ///< L2 norm of the difference over that of the reference; else the mean of its absolute values
  double harm;  ///< an error of this size is felt: levers that do less are combined
};
inline constexpr std::array<Quantity, 7> quantities{{
    {"discharge", "discharge rate", "relative", true, 0.02},
    {"quasi_static", "quasi-static share", "difference of shares", false, 0.02},
    {"tracer", "tracer share of the outflow, F(t)", "mean difference", false, 0.02},
    {"pressure", "pressure at probes", "relative, L2", true, 0.05},
    {"surface", "height of the surface at the end", "mean difference over the width", false, 0.01},
    {"velocity", "velocity", "relative, L2", true, 0.05},
    {"mass_defect", "mass defect", "share of the initial mass", false, 1e-5},
}};

/// Numbers of each quantity by its key, in the same order whatever the grid; a quantity that the run has not is missing.
using Record = std::map<std::string, std::vector<double>>;

/// The first number of a quantity; NaN if it is missing.
double first_of(const Record& record, const char* quantity);
/// Size of the numbers of a quantity: L2 or mean absolute value.
double size_of(const Quantity& quantity, const std::vector<double>& values);
/// NaN where either is missing; the mass defect is its own error.
double distance(const Quantity& quantity, const Record& run, const Record& reference);

/// The numbers at vanishing cells, from three grids each with cells half the size of the one before: at one order for
/// all numbers of a quantity, observed in the norm of the quantity (studies/richardson.hpp).
struct ReferenceQuantity {
  std::vector<double> values;
  double order = 0;      ///< 0: none, the values are those of the finest grid
  double error_bar = 0;  ///< as distance() measures
  std::string doubt;     ///< as of Richardson
};
ReferenceQuantity reference_of(const Quantity& quantity, const std::vector<double>& coarse,
                               const std::vector<double>& middle, const std::vector<double>& fine);

void write_record(const std::filesystem::path& path, const Record& record);
/// Throws std::runtime_error if the file cannot be read.
Record read_record(const std::filesystem::path& path);

/// Keeps the quantities of one run. Places are those of `whole`; `halved`: the run is of its right half.
class Recorder : public Observer {
 public:
  /// Of the whole scene, which has an end: run a scene with this output.fields_every, so that samples come at the same
  /// times on every grid.
  static double sample_interval(const Scene& whole);

  Recorder(const Scene& whole, bool halved);
  void on_series(const SeriesRow& row) override { rows_.push_back(row); }
  void on_fields(const Simulation& simulation) override;
  /// To be told of the end of the run.
  void at_end(const Simulation& simulation);
  /// What there is of it. A run that ends before the whole scene does has no tracer curve and no surface.
  Record record(const Summary& summary) const;

 private:
  struct Place {
    double x, y, sign;  ///< sign: of the velocity's x-component
  };
  Place place(double x, double y) const;

  const Scene& whole_;
  bool halved_;
  double developed_;  ///< when the flow counts as developed [T]
  std::vector<std::array<double, 2>> probes_;
  std::vector<SeriesRow> rows_;
  std::vector<double> pressure_;  ///< sums over samples
  int samples_ = 0;
  std::vector<double> velocity_, surface_;
};

/// Noise of at most `speed` on every inner face, the same for the same seed.
void add_noise(Simulation& simulation, double speed, unsigned seed);

}  // namespace hourglass
