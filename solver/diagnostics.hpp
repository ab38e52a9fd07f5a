#pragma once
// Figures of merit from fields. Masses are per unit depth [M]; sums are row by row in fixed order.
#include <optional>
#include <string>
#include <vector>

#include "kernels/geometry.hpp"
#include "solver/boundary_of.hpp"
#include "solver/fields.hpp"
#include "solver/rheology.hpp"
#include "solver/scene.hpp"
#include "solver/simulation.hpp"
#include "solver/vof.hpp"

namespace hourglass {

/// Mass of each material in the domain; the sum is the mass of grains. With dilatancy by packing; `by_volume`: as if
/// all were at rest. Of the whole silo: both halves of a mirrored one, all around an axis. geometry here and below:
/// nullptr, or that of the scene.
std::vector<double> masses_by_material(const Scene& scene, const Fields& fields, const Geometry* geometry,
                                       int threads, bool by_volume = false);

/// 1 where the equations of mu(I) are well posed at the I of the last step (granular_laws.hpp, well_posedness) or the
/// viscosity stands at eta_max and is a number, 0 where they are not; 1 where grains fill less than half.
CellField well_posed_cells(const Scene& scene, const Fields& fields, const RheologyStage& rheology);

/// Share of the cells with grains where they are not; 0 for law newtonian and mu_I_regularised.
double ill_posed_fraction(const Scene& scene, const Fields& fields, const Geometry* geometry,
                          const RheologyStage& rheology, int threads);

/// Fastest cell-centred speed where grains fill at least half of the cell.
double fastest_grains(const Fields& fields, const Geometry* geometry, int threads);

/// Whether every velocity and pressure is a finite number; where not, the first place.
std::string not_finite(const Fields& fields);

/// Mass of one material that left through shares of boundary faces in the last step, outward positive; of the whole silo.
double mass_through(const Scene& scene, const PhaseFlux& flux, Side side, const std::vector<OpenFace>& faces,
                    int material);

/// Samples of mass over time, and the rate of its loss.
struct DischargeWindow {
  double rate = 0;  ///< least-squares slope of mass over time, negated [M/T]
  double from = 0, to = 0;
};
DischargeWindow discharge(const Scene& scene, const History& mass);
/// Negated least-squares slope of a history between two times; 0 with fewer than two samples there.
double loss_rate(const History& history, double from, double to);
/// Mean of a history's samples between two times; nullopt with none there.
std::optional<double> mean_over(const History& history, double from, double to);

/// How many orifices of the whole silo one of the scene stands for: 2 beside its image in a mirror plane.
int images(const Scene& scene, const Orifice& orifice);

/// Widths of all orifices of the whole silo [L]; around an axis of those on the axis alone, for others are rings.
double total_width(const Scene& scene);

/// Scale of the discharge of orifices of this width altogether: rho sqrt(g) W^1.5; around an axis, where densities are by
/// volume, rho sqrt(g) W^2.5 [M/T].
double discharge_scale(const Scene& scene, double width);

/// Time after which the discharge counts as developed: 2.5 sqrt(W/g), W the widest orifice: 10.8
/// sqrt(d/g) for the base scene, as in docs/accuracy.md.
double start_up_time(const Scene& scene);

}  // namespace hourglass
