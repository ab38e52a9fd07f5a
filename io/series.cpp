#include "io/series.hpp"

#include <fmt/format.h>

#include "io/csv.hpp"
#include "solver/quasi_static.hpp"

namespace hourglass {
std::string series_header(const Scene& scene) {
  std::string out = "t,step,dt,mass,outflow";
  for (std::size_t k = 0; k < scene.orifices.size(); ++k) out += fmt::format(",outflow_{}", k);
  for (const Material& m : scene.materials) {
    out += ',' + csv_cell(m.name + "_mass") + ',' + csv_cell(m.name + "_outflow");
  }
  return out +
         ",quasi_static_fraction,max_speed,iterations_pressure,iterations_viscous,iterations_fluidity,"
         "max_divergence,capped_cells,wall_seconds,dt_limit,ill_posed_fraction" +
         (scene.feed ? ",fed" : "") + ",quasi_static_1e-2,quasi_static_1e-4" +
         (flat_tops(scene).empty() ? "" : ",quasi_static_above_flat_top");
}

std::string series_text(const SeriesRow& row) {
  const StepReport& s = row.step;
  std::string out = fmt::format("{},{},{},{},{}", s.t, s.step, s.dt, row.mass, row.outflow);
  for (const double q : row.orifice_outflow) out += fmt::format(",{}", q);
  for (std::size_t m = 0; m < row.material_mass.size(); ++m) {
    out += fmt::format(",{},{}", row.material_mass[m], row.material_outflow[m]);
  }
  return out +
         fmt::format(",{},{},{},{},{},{},{},{},{},{}", row.quasi_static_fraction, row.max_speed,
                     s.pressure.iterations, s.viscous.iterations, s.fluidity.iterations, s.max_divergence,
                     s.capped_cells, row.wall_seconds, name_of(s.limit), row.ill_posed_fraction) +
         (row.fed ? fmt::format(",{}", *row.fed) : "") +
         fmt::format(",{},{}", row.quasi_static_1e2, row.quasi_static_1e4) +
         (row.quasi_static_above_flat_top ? fmt::format(",{}", *row.quasi_static_above_flat_top) : "");
}

}  // namespace hourglass
