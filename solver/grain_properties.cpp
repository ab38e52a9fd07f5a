#include "solver/grain_properties.hpp"

#include "kernels/rheology.hpp"

namespace hourglass {
namespace {

constexpr int scratch_rows = 8;
thread_local std::vector<double> row_memory;
thread_local std::vector<const double*> share_rows;

}  // namespace

GrainProperties::GrainProperties(const Scene& scene) {
  for (const Material& m : scene.materials) {
    const auto add = [&](Property p, double value) { values_[p].push_back(value); };
    const Grain& g = grains_.emplace_back(grain_of(m));
    add(mu_s, g.mu_s);
    add(delta_mu, g.delta_mu);
    add(I_0, g.I_0);
    add(d_sqrt_rho, g.d_sqrt_rho());
    add(cohesion, g.cohesion);
    add(viscosity, m.viscosity);
    add(A_d, (m.A ? *m.A : scene.nonlocal ? scene.nonlocal->A : 0) * m.diameter);
    add(phi_g, m.phi_g ? *m.phi_g : scene.dilatancy ? scene.dilatancy->phi_g : 0);
    add(F, m.F ? *m.F : scene.wall_friction ? scene.wall_friction->strength() : 0);
  }
  for (int p = 0; p < count; ++p)
    equal_[p] = std::all_of(values_[p].begin(), values_[p].end(),
                            [&](double value) { return value == values_[p].front(); });
}

bool GrainProperties::equal_law() const {
  return equal_[mu_s] && equal_[delta_mu] && equal_[I_0] && equal_[d_sqrt_rho] && equal_[cohesion] &&
         equal_[viscosity];
}

GrainProperties::Rows::Rows(const GrainProperties& properties, const Fields& fields, int j)
    : properties_(properties), n_(fields.p.nx()), shares_(share_rows), memory_(row_memory) {
  const int tracers = static_cast<int>(fields.tracers.size());
  const std::size_t needed = static_cast<std::size_t>(count + scratch_rows + tracers) * stride();
  if (memory_.size() < needed) memory_.resize(needed);
  shares_.clear();
  for (int k = 0; k < tracers; ++k) {
    double* share = row(count + scratch_rows + k);
    share_row(fields.tracers[k].row(j), fields.grains.row(j), n_, share);
    shares_.push_back(share);
  }
}

const double* GrainProperties::Rows::operator[](Property p) {
  double* out = row(p);
  if (!made_[p]) {
    made_[p] = true;
    if (properties_.equal(p)) {
      std::fill(out, out + n_, properties_.by_material(p).front());
    } else {
      blend_row(properties_.by_material(p), shares_, n_, out);
    }
  }
  return out;
}

double* GrainProperties::Rows::scratch(int k) { return row(count + k); }

}  // namespace hourglass
