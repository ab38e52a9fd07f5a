#include "perf/plain.hpp"

namespace hourglass::plain {
namespace {

/// f(i) for the points of one colour in a row of n, counted from the nearer end (take_colour in
/// kernels/velocity.hpp).
template <class F>
void each_of_colour(int n, int j, int colour, F f) {
  const int half = (n + 1) / 2, first = (colour + j) & 1;
  for (int i = first; i < half; i += 2) f(i);
  for (int i = n - 1 - first; i >= half; i -= 2) f(i);
}

/// x(i, j) = value(i, j) at the points of one colour. Two points at the middle of a row may share it: old
/// values first.
template <class F, class Value>
void update(F& x, int colour, Value value) {
  thread_local std::vector<float> fresh;
  fresh.resize(x.nx());
  for (int j = 0; j < x.ny(); ++j) {
    each_of_colour(x.nx(), j, colour, [&](int i) { fresh[i] = value(i, j); });
    each_of_colour(x.nx(), j, colour, [&](int i) { x(i, j) = fresh[i]; });
  }
}

float force_u(const Viscous& a, const FaceUnknown& x, int i, int j) {
  const auto& [u, v] = x;
  const float normal = a.eta_c(i, j) * (u(i, j) - u(i + 1, j)) + a.eta_c(i - 1, j) * (u(i, j) - u(i - 1, j));
  const float north = (u(i, j) - u(i, j + 1)) - (v(i, j + 1) - v(i - 1, j + 1));
  const float south = (u(i, j) - u(i, j - 1)) + (v(i, j) - v(i - 1, j));
  return a.mass.u(i, j) * u(i, j) + 2 * normal + a.eta_n(i, j + 1) * north + a.eta_n(i, j) * south;
}

float force_v(const Viscous& a, const FaceUnknown& x, int i, int j) {
  const auto& [u, v] = x;
  const float normal = a.eta_c(i, j) * (v(i, j) - v(i, j + 1)) + a.eta_c(i, j - 1) * (v(i, j) - v(i, j - 1));
  const float east = (v(i, j) - v(i + 1, j)) - (u(i + 1, j) - u(i + 1, j - 1));
  const float west = (v(i, j) - v(i - 1, j)) + (u(i, j) - u(i, j - 1));
  return a.mass.v(i, j) * v(i, j) + 2 * normal + a.eta_n(i + 1, j) * east + a.eta_n(i, j) * west;
}

float outflow(const Poisson& a, const CellUnknown& q, int i, int j) {
  return a.beta.u(i + 1, j) * (q(i, j) - q(i + 1, j)) + a.beta.u(i, j) * (q(i, j) - q(i - 1, j)) +
         a.beta.v(i, j + 1) * (q(i, j) - q(i, j + 1)) + a.beta.v(i, j) * (q(i, j) - q(i, j - 1));
}

/// f(i, j, weight) for the coarse points of u that the fine point (i, j) of u is interpolated from.
template <class F>
void each_coarse_u(const Boundary& coarse, int ny, int i, int j, F f) {
  const int near = j / 2, other = j % 2 == 0 ? near - 1 : near + 1;
  const float along = i % 2 == 0 ? 1.0f : 0.5f;
  for (int k = i / 2; k <= (i + 1) / 2; ++k) {
    if (other < 0 || other >= ny) {
      const double ghost = ghost_factor((other < 0 ? coarse.bottom : coarse.top).shear[k]);
      f(k, near, along * static_cast<float>(0.75 + 0.25 * ghost));
    } else {
      f(k, near, along * 0.75f);
      f(k, other, along * 0.25f);
    }
  }
}
template <class F>
void each_coarse_v(const Boundary& coarse, int nx, int i, int j, F f) {
  const int near = i / 2, other = i % 2 == 0 ? near - 1 : near + 1;
  const float along = j % 2 == 0 ? 1.0f : 0.5f;
  for (int k = j / 2; k <= (j + 1) / 2; ++k) {
    if (other < 0 || other >= nx) {
      const double ghost = ghost_factor((other < 0 ? coarse.left : coarse.right).shear[k]);
      f(near, k, along * static_cast<float>(0.75 + 0.25 * ghost));
    } else {
      f(near, k, along * 0.75f);
      f(other, k, along * 0.25f);
    }
  }
}

/// ELVIRA: of six candidates the line that fits the block best (kernels/plic.hpp).
Line reconstruct(const Block& c) {
  double column[3] = {}, row[3] = {};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      column[a] += c[a][b];
      row[b] += c[a][b];
    }
  const auto sign = [](double x) { return x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0; };
  const double side_x = sign(column[0] - column[2]), side_y = sign(row[0] - row[2]);
  const double slope_x[3] = {(column[0] - column[2]) / 2, column[0] - column[1], column[1] - column[2]};
  const double slope_y[3] = {(row[0] - row[2]) / 2, row[0] - row[1], row[1] - row[2]};
  double misfit[6];
  Line line[6];
  for (int k = 0; k < 6; ++k) {
    const double nx = k < 3 ? slope_x[k] : side_x, ny = k < 3 ? side_y : slope_y[k - 3];
    const double size = std::abs(nx) + std::abs(ny);
    misfit[k] = size > 0 ? 0 : 100;
    if (size == 0) continue;
    const double x = std::abs(nx / size), y = std::abs(ny / size);
    line[k] = {nx / size, ny / size, line_constant(x, y, c[1][1])};
    for (int a = -1; a <= 1; ++a)
      for (int b = -1; b <= 1; ++b) {
        const double alpha = line[k].alpha - (nx > 0 ? a : -a) * x - (ny > 0 ? b : -b) * y;
        misfit[k] += std::abs(area_below(x, y, alpha) - c[1 + a][1 + b]);
      }
  }
  // Centred, backward, forward; a tie of the last two is the first, as in a mirror.
  const auto best_of = [&](int k) {
    if (misfit[k + 1] == misfit[k + 2]) return k;
    const int side = misfit[k + 1] < misfit[k + 2] ? k + 1 : k + 2;
    return misfit[side] < misfit[k] ? side : k;
  };
  const int along_y = best_of(0), along_x = best_of(3);
  return line[misfit[along_y] <= misfit[along_x] ? along_y : along_x];
}

double share_leaving(const Block& block, double shift) {
  const double width = std::abs(shift);
  const Line line = reconstruct(block);
  if (line.nx == 0 && line.ny == 0) return width * block[1][1];
  const double begin = (line.nx > 0) == (shift > 0) ? 1 - width : 0;
  return std::min(block[1][1],
                  area_in_rectangle(std::abs(line.nx), std::abs(line.ny), line.alpha, begin, 0, width, 1));
}

/// q at the face between two points of a line of four, and the mass that goes through it.
double carried(const double (&q)[4], double flag_before, double flag_after, double flux, double courant) {
  const double ahead = 0.5 * (1 - courant);
  if (flux > 0) return q[1] + ahead * flag_before * limited(q[1] - q[0], q[2] - q[1]);
  return q[2] - ahead * flag_after * limited(q[2] - q[1], q[3] - q[2]);
}

}  // namespace

void relax(const Viscous& a, FaceUnknown& x, const FaceUnknown& b, bool reversed) {
  const auto& inv = a.inverse_diagonal;
  for (int pass = 0; pass < 4; ++pass) {
    const int stage = reversed ? 3 - pass : pass;
    if (stage < 2) {
      update(x.u, stage,
             [&](int i, int j) { return x.u(i, j) + inv.u(i, j) * (b.u(i, j) - force_u(a, x, i, j)); });
    } else {
      update(x.v, stage - 2,
             [&](int i, int j) { return x.v(i, j) + inv.v(i, j) * (b.v(i, j) - force_v(a, x, i, j)); });
    }
  }
}

void relax(const Poisson& a, CellUnknown& x, const CellUnknown& b, bool reversed) {
  for (int pass = 0; pass < 2; ++pass)
    update(x, reversed ? 1 - pass : pass, [&](int i, int j) {
      return x(i, j) + a.inverse_diagonal(i, j) * (b(i, j) - outflow(a, x, i, j));
    });
}

void residual(const Viscous& a, const FaceUnknown& x, const FaceUnknown& b, FaceUnknown& r) {
  const auto& inv = a.inverse_diagonal;
  for (int j = 0; j < r.u.ny(); ++j)
    for (int i = 0; i < r.u.nx(); ++i) r.u(i, j) = inv.u(i, j) == 0 ? 0 : b.u(i, j) - force_u(a, x, i, j);
  for (int j = 0; j < r.v.ny(); ++j)
    for (int i = 0; i < r.v.nx(); ++i) r.v(i, j) = inv.v(i, j) == 0 ? 0 : b.v(i, j) - force_v(a, x, i, j);
}

void residual(const Poisson& a, const CellUnknown& x, const CellUnknown& b, CellUnknown& r) {
  for (int j = 0; j < r.ny(); ++j)
    for (int i = 0; i < r.nx(); ++i) r(i, j) = b(i, j) - outflow(a, x, i, j);
}

void prolong(const FaceUnknown& coarse, const Boundary& coarse_boundary, const FaceUnknown& inverse_diagonal,
             FaceUnknown& fine) {
  const Patch& p = coarse.patch();
  for (int j = 0; j < fine.u.ny(); ++j)
    for (int i = 0; i < fine.u.nx(); ++i) {
      if (inverse_diagonal.u(i, j) == 0) continue;
      each_coarse_u(coarse_boundary, p.ny, i, j,
                    [&](int k, int l, float w) { fine.u(i, j) += w * coarse.u(k, l); });
    }
  for (int j = 0; j < fine.v.ny(); ++j)
    for (int i = 0; i < fine.v.nx(); ++i) {
      if (inverse_diagonal.v(i, j) == 0) continue;
      each_coarse_v(coarse_boundary, p.nx, i, j,
                    [&](int k, int l, float w) { fine.v(i, j) += w * coarse.v(k, l); });
    }
}

void restrict(const FaceUnknown& fine, const Boundary& coarse_boundary, FaceUnknown& coarse) {
  const Patch& p = coarse.patch();
  coarse.fill(0);
  for (int j = 0; j < fine.u.ny(); ++j)
    for (int i = 0; i < fine.u.nx(); ++i)
      each_coarse_u(coarse_boundary, p.ny, i, j,
                    [&](int k, int l, float w) { coarse.u(k, l) += w * fine.u(i, j); });
  for (int j = 0; j < fine.v.ny(); ++j)
    for (int i = 0; i < fine.v.nx(); ++i)
      each_coarse_v(coarse_boundary, p.nx, i, j,
                    [&](int k, int l, float w) { coarse.v(k, l) += w * fine.v(i, j); });
}

void prolong(const Poisson& a, const CellUnknown& coarse, CellUnknown& fine) {
  const int nx = coarse.nx(), ny = coarse.ny();
  const auto weight = [&](float beta, int i, int j) {
    return 0.25f * interpolation_weight(beta, a.inverse_diagonal(i, j));
  };
  for (int j = 0; j < fine.ny(); ++j) {
    const int near = j / 2, other = j % 2 == 0 ? near - 1 : near + 1, face = j % 2 == 0 ? near : near + 1;
    const auto line = [&](int i) {
      const float far = other < 0 || other >= ny ? -coarse(i, near) : coarse(i, other);
      return coarse(i, near) + weight(a.beta.v(i, face), i, near) * (far - coarse(i, near));
    };
    for (int i = 0; i < fine.nx(); ++i) {
      const int k = i / 2, beside = i % 2 == 0 ? k - 1 : k + 1;
      const float here = line(k), there = beside < 0 || beside >= nx ? -here : line(beside);
      fine(i, j) += here + weight(a.beta.u(i % 2 == 0 ? k : k + 1, near), k, near) * (there - here);
    }
  }
}

void restrict(const CellUnknown& fine, CellUnknown& coarse) {
  for (int j = 0; j < coarse.ny(); ++j)
    for (int i = 0; i < coarse.nx(); ++i)
      coarse(i, j) =
          fine(2 * i, 2 * j) + fine(2 * i + 1, 2 * j) + fine(2 * i, 2 * j + 1) + fine(2 * i + 1, 2 * j + 1);
}

template <At face>
void vof_sweep(CellField& grains, const Field<face>& velocity, double dt_h, const DilationOwner& owner,
               Field<face>& flux) {
  constexpr int di = face == At::xface ? 1 : 0, dj = 1 - di;
  for (int j = 0; j < velocity.ny(); ++j)
    for (int i = 0; i < velocity.nx(); ++i) {
      const double u = velocity(i, j);
      const int k = u > 0 ? i - di : i, l = u > 0 ? j - dj : j;
      const double share = grains(k, l);
      if (k < 0 || k >= grains.nx() || l < 0 || l >= grains.ny()) {
        flux(i, j) = 0;  // only air comes in
      } else if (share > 0 && share < 1 && u != 0) {
        Block block;
        for (int a = -1; a <= 1; ++a)
          for (int b = -1; b <= 1; ++b)
            block[1 + a][1 + b] = di == 1 ? grains(k + a, l + b) : grains(k + b, l + a);
        flux(i, j) = std::copysign(share_leaving(block, u * dt_h), u);
      } else {
        flux(i, j) = share * u * dt_h;
      }
    }
  for (int j = 0; j < grains.ny(); ++j)
    for (int i = 0; i < grains.nx(); ++i) {
      const double dilation = owner(i, j) > 0 ? velocity(i + di, j + dj) - velocity(i, j) : 0;
      const double net = flux(i + di, j + dj) - flux(i, j);
      grains(i, j) = without_wisps(grains(i, j) - net + dilation * dt_h, 1);
    }
  fill_vof_halo({}, {0, grains.ny()}, grains);
}
template void vof_sweep(CellField&, const XFaceField&, double, const DilationOwner&, XFaceField&);
template void vof_sweep(CellField&, const YFaceField&, double, const DilationOwner&, YFaceField&);

void advect(const Velocity& w, const MassTransport& mass, double dt_h, Velocity& out) {
  const XFaceField& u = w.u;
  const YFaceField& v = w.v;
  const int ny = w.patch().ny;
  const auto& uniform = mass.uniform;
  const auto flag_u = [&](int i, int j) { return double(uniform(i - 1, j) * uniform(i, j)); };
  const auto flag_v = [&](int i, int j) {  // beyond the halo the flag is that of the halo, 0
    return double(uniform(i, std::max(j - 1, -1)) * uniform(i, std::min(j, ny)));
  };
  const auto v_at = [&](int i, int j) { return v(i, std::clamp(j, -1, ny + 1)); };
  // Σ over the two faces along an axis: q and flags of a point, flux and velocity of a face, all by offset.
  const auto along = [&](auto q, auto flag, auto flux, auto velocity) {
    double sum = 0;
    for (int k : {0, 1}) {
      const double four[4] = {q(k - 2), q(k - 1), q(k), q(k + 1)};
      const double through = flux(k);
      const double value = carried(four, flag(k - 1), flag(k), through, std::abs(velocity(k)) * dt_h);
      sum += (k == 1 ? through : -through) * (value - q(0));
    }
    return sum;
  };
  for (int j = 0; j < out.u.ny(); ++j)
    for (int i = 0; i < out.u.nx(); ++i)
      out.u(i, j) = along([&](int k) { return u(i + k, j); }, [&](int k) { return flag_u(i + k, j); },
                          [&](int k) { return 0.5 * (mass.x(i + k - 1, j) + mass.x(i + k, j)); },
                          [&](int k) { return 0.5 * (u(i + k - 1, j) + u(i + k, j)); }) +
                    along([&](int k) { return u(i, j + k); }, [&](int k) { return flag_u(i, j + k); },
                          [&](int k) { return 0.5 * (mass.y(i - 1, j + k) + mass.y(i, j + k)); },
                          [&](int k) { return 0.5 * (v(i - 1, j + k) + v(i, j + k)); });
  for (int j = 0; j < out.v.ny(); ++j)
    for (int i = 0; i < out.v.nx(); ++i)
      out.v(i, j) = along([&](int k) { return v(i + k, j); }, [&](int k) { return flag_v(i + k, j); },
                          [&](int k) { return 0.5 * (mass.x(i + k, j - 1) + mass.x(i + k, j)); },
                          [&](int k) { return 0.5 * (u(i + k, j - 1) + u(i + k, j)); }) +
                    along([&](int k) { return v_at(i, j + k); }, [&](int k) { return flag_v(i, j + k); },
                          [&](int k) { return 0.5 * (mass.y(i, j + k - 1) + mass.y(i, j + k)); },
                          [&](int k) { return 0.5 * (v(i, j + k - 1) + v(i, j + k)); });
}

void shear_rate_squared(const Velocity& w, CellField& gamma2) {
  const XFaceField& u = w.u;
  const YFaceField& v = w.v;
  const double h = gamma2.patch().h;
  const auto corner = [&](int i, int j) { return (u(i, j) - u(i, j - 1) + v(i, j) - v(i - 1, j)) / h; };
  for (int j = 0; j < gamma2.ny(); ++j)
    for (int i = 0; i < gamma2.nx(); ++i) {
      const double exx = (u(i + 1, j) - u(i, j)) / h, eyy = (v(i, j + 1) - v(i, j)) / h;
      const double shear = 0.25 * (corner(i, j) + corner(i + 1, j) + corner(i, j + 1) + corner(i + 1, j + 1));
      gamma2(i, j) = 2 * (exx * exx + eyy * eyy) + shear * shear;
    }
}

void smooth(SmoothingPass pass, CellField& f, CellField& spare) {
  const int nx = f.nx(), ny = f.ny(), s = pass.stride;
  const double w = pass.weight;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      spare(i, j) = (1 - 2 * w) * f(i, j) + w * ((i >= s ? f(i - s, j) : 0) + (i + s < nx ? f(i + s, j) : 0));
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      f(i, j) = (1 - 2 * w) * spare(i, j) +
                w * ((j >= s ? spare(i, j - s) : 0) + (j + s < ny ? spare(i, j + s) : 0));
}

void granular_viscosity(const CellField& gamma2, const CellField& p, const CellField& grains, const Grain& g,
                        const ViscosityLimits& limits, CellField& eta) {
  for (int j = 0; j < eta.ny(); ++j)
    for (int i = 0; i < eta.nx(); ++i) {
      const double pressure = std::max(p(i, j) + limits.background_pressure, 0.0);
      const double raw = hourglass::granular_viscosity(std::sqrt(gamma2(i, j)), pressure, g);
      const double c = grains(i, j);
      eta(i, j) = c * std::clamp(raw, limits.eta_min, limits.eta_max) + (1 - c) * limits.air;
    }
}

void corner_viscosity(const CellUnknown& eta_c, const Boundary& boundary, CornerFieldOf<float>& eta_n) {
  const int nx = eta_c.nx(), ny = eta_c.ny();
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const int l = std::max(i - 1, 0), r = std::min(i, nx - 1), d = std::max(j - 1, 0),
                t = std::min(j, ny - 1);
      const float mean = 4 / (1 / eta_c(l, d) + 1 / eta_c(r, d) + 1 / eta_c(l, t) + 1 / eta_c(r, t));
      const bool side = i == 0 || i == nx, base = j == 0 || j == ny;
      double weight = side || base ? 0 : 1;
      if (side) weight += (i == 0 ? boundary.left : boundary.right).shear[j];
      if (base) weight += (j == 0 ? boundary.bottom : boundary.top).shear[i];
      eta_n(i, j) = mean * static_cast<float>(side && base ? weight / 2 : weight);
    }
}

}  // namespace hourglass::plain
