#pragma once
// The plain twin of each hot kernel: the formula at every point, in scalar code, one pass after the other.
// What a kernel must equal to rounding, and what its speed is counted in. Not for periodic patches.
#include "kernels/momentum.hpp"
#include "kernels/poisson.hpp"
#include "kernels/rheology.hpp"
#include "kernels/strain_rate.hpp"
#include "kernels/viscous.hpp"
#include "kernels/vof_sweep.hpp"

namespace hourglass::plain {

using FaceUnknown = VelocityOf<float>;
using CellUnknown = CellFieldOf<float>;
using Viscous = ViscousCoefficients<float>;
using Poisson = PoissonCoefficients<float>;

/// One red-black Gauss-Seidel sweep, u before v; `reversed`: the colours and components the other way round.
void relax(const Viscous& a, FaceUnknown& x, const FaceUnknown& b, bool reversed);
void relax(const Poisson& a, CellUnknown& x, const CellUnknown& b, bool reversed);

/// r = b - A x, 0 on fixed faces.
void residual(const Viscous& a, const FaceUnknown& x, const FaceUnknown& b, FaceUnknown& r);
void residual(const Poisson& a, const CellUnknown& x, const CellUnknown& b, CellUnknown& r);

/// fine += P coarse on unknown points, and coarse = the transpose of that (the pressure's: the sum of four
/// cells).
void prolong(const FaceUnknown& coarse, const Boundary& coarse_boundary, const FaceUnknown& inverse_diagonal,
             FaceUnknown& fine);
void restrict(const FaceUnknown& fine, const Boundary& coarse_boundary, FaceUnknown& coarse);
void prolong(const Poisson& coarse_coefficients, const CellUnknown& coarse, CellUnknown& fine);
void restrict(const CellUnknown& fine, CellUnknown& coarse);

/// One directional sweep of the grains, and their halo; no tracers.
template <At face>
void vof_sweep(CellField& grains, const Field<face>& velocity, double dt_h, const DilationOwner& owner,
               Field<face>& flux);

/// Σ M (u_face - u) on every face.
void advect(const Velocity& w, const MassTransport& mass, double dt_h, Velocity& out);

void shear_rate_squared(const Velocity& w, CellField& gamma2);
void smooth(SmoothingPass pass, CellField& f, CellField& spare);
void granular_viscosity(const CellField& gamma2, const CellField& p, const CellField& grains, const Grain& g,
                        const ViscosityLimits& limits, CellField& eta);
void corner_viscosity(const CellUnknown& eta_c, const Boundary& boundary, CornerFieldOf<float>& eta_n);

}  // namespace hourglass::plain
