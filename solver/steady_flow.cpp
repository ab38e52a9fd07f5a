#include "solver/steady_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <variant>

#include "kernels/team.hpp"
#include "solver/boundary_of.hpp"
#include "solver/diagnostics.hpp"
#include "solver/geometry.hpp"
#include "solver/models/stochastic.hpp"
#include "solver/painting.hpp"
#include "solver/quasi_static.hpp"
#include "solver/simulation_state.hpp"

namespace hourglass {
namespace {

constexpr double degree = M_PI / 180;

/// A field in polar coordinates from the apex of a hopper's walls.
struct RadialFlow {
  RadialField field;
  double half_angle, x, y;  // [rad]; the apex [L]
  double f_0;               // v_r = -f_0 f / r^m
  int m;
  double weight;  // rho g
  bool walled;    // what lies outside is solid: cells that the wall cuts take what is at the wall

  /// r and theta of a place; nullopt outside of the hopper.
  std::optional<std::array<double, 2>> polar(double px, double py) const {
    const double theta = std::atan2(std::abs(px - x), py - y);
    if (theta > half_angle && !walled) return std::nullopt;
    return std::array{std::hypot(px - x, py - y), std::min(theta, half_angle)};
  }
  PointVelocity velocity(double px, double py) const {
    const auto place = polar(px, py);
    if (!place) return {};
    const auto [r, theta] = *place;
    const double v = -f_0 * field.at(theta).f / std::pow(r, m);
    return {v * (px - x) / r, v * (py - y) / r};
  }
  double pressure(double px, double py) const {
    const auto place = polar(px, py);
    return place ? weight * (*place)[0] * field.at((*place)[1]).q : 0;
  }
};

RadialFlow radial_flow(const Scene& scene) {
  const RadialHopper hopper = radial_hopper(scene);
  const auto field = radial_field(hopper);
  if (!field) throw std::invalid_argument("model radial: no field beyond the mass-flow limit");
  const Orifice& outlet = scene.orifices.front();
  const double density = scene.materials[0].density, flux = field->flux();
  return {*field,
          hopper.half_angle,
          outlet.centre,
          -0.5 * outlet.width / std::tan(hopper.half_angle),
          *scene.radial->Q / density / flux,
          hopper.cone ? 2 : 1,
          density * scene.g(),
          scene.hopper.has_value()};
}

/// What Q is by default: of each orifice what discharge_scale() gives for it alone.
double usual_discharge(const Scene& scene) {
  double sum = 0;
  for (const Orifice& o : scene.orifices) sum += images(scene, o) * discharge_scale(scene, o.width);
  return sum;
}

double discharge_of(const Scene& s) {
  return s.model == Model::kinematic    ? *s.kinematic->Q
         : s.model == Model::stochastic ? *s.stochastic->Q
                                        : *s.radial->Q;
}

template <class T, class Value>
void set_if_open(std::optional<T>& value, Value&& usual) {
  if (!value) value = usual;
}

}  // namespace

void resolve_model(Scene& s) {
  if (s.model == Model::mu_I || s.materials.empty()) return;
  const double d = s.materials[0].diameter, Q = usual_discharge(s);
  const auto block = [](auto& module) -> auto& { return module ? *module : module.emplace(); };
  if (s.model == Model::kinematic) {
    Kinematic& k = block(s.kinematic);
    set_if_open(k.B, 2 * d);
    set_if_open(k.Q, Q);
  } else if (s.model == Model::stochastic) {
    Stochastic& k = block(s.stochastic);
    set_if_open(k.L_s, 4 * d);
    set_if_open(k.Q, Q);
  } else {
    Radial& r = block(s.radial);
    set_if_open(r.phi, std::asin(std::min(s.materials[0].mu_s, 1.0)) / degree);
    set_if_open(r.phi_w, 0.5 * *r.phi);
    set_if_open(r.half_angle, s.hopper ? s.hopper->half_angle : 90 - *r.phi);
    set_if_open(r.Q, Q);
  }
}

Floor floor_of(const Scene& scene, double Q, OrificeForm form) {
  const auto side = [&](Side which) {
    const Wall wall = scene.wall(which);
    return wall == Wall::open       ? SideImages::open
           : wall == Wall::periodic ? SideImages::periodic
                                    : SideImages::closed;
  };
  Floor floor{
      scene.width, scene.left_is_middle() ? SideImages::closed : side(Side::left), side(Side::right), {}};
  const double scale = Q / scene.materials[0].density / usual_discharge(scene);
  for (const Orifice& o : scene.orifices) {
    const double rate = scale * discharge_scale(scene, o.width);
    if (form == OrificeForm::point) {
      const bool halved = scene.left_is_middle() && images(scene, o) == 1 && o.centre < 0.25 * o.width;
      floor.sources.push_back({o.centre, o.centre, halved ? 0.5 * rate : rate});
      continue;
    }
    const double from = std::max(o.centre - 0.5 * o.width, 0.0), to = o.centre + 0.5 * o.width;
    floor.sources.push_back({from, to, rate * (to - from) / o.width});  // the image has the rest of it
  }
  return floor;
}

RadialHopper radial_hopper(const Scene& scene) {
  const Radial& r = *scene.radial;
  return {*r.phi * degree, *r.phi_w * degree, *r.half_angle * degree, scene.axisymmetric(), r.wall_angle};
}

struct SteadyModel::Impl {
  std::variant<KinematicFlow, StochasticFlow, RadialFlow> model;

  static Impl of(const Scene& s) {
    if (s.model == Model::kinematic) {
      const Kinematic& k = *s.kinematic;
      return {KinematicFlow(floor_of(s, *k.Q, k.orifices), *k.B)};
    }
    if (s.model == Model::stochastic) {
      const Stochastic& k = *s.stochastic;
      return {StochasticFlow(floor_of(s, *k.Q, k.orifices), *k.L_s, k.spot)};
    }
    if (s.model == Model::radial) return {radial_flow(s)};
    throw std::invalid_argument("model mu_I is no steady field: it is solved by a Simulation");
  }
};

SteadyModel::SteadyModel(const Scene& scene) {
  Scene resolved = scene;
  resolve_model(resolved);
  impl_ = std::make_unique<Impl>(Impl::of(resolved));
}
SteadyModel::~SteadyModel() = default;

PointVelocity SteadyModel::velocity(double x, double y) const {
  struct Evaluate {
    double x, y;
    PointVelocity operator()(const KinematicFlow& flow) const { return flow.at(x, y); }
    PointVelocity operator()(const StochasticFlow& flow) const { return flow.at(x, y); }
    PointVelocity operator()(const RadialFlow& flow) const { return flow.velocity(x, y); }
  };
  return std::visit(Evaluate{x, y}, impl_->model);
}

double SteadyModel::pressure(double x, double y) const {
  const auto* radial = std::get_if<RadialFlow>(&impl_->model);
  return radial ? radial->pressure(x, y) : 0;
}

SteadyFlow steady_flow(const Scene& given) {
  const auto start = Clock::now();
  Scene scene = given;
  resolve_model(scene);
  const SteadyModel model(scene);
  const Patch patch = scene.patch();
  const auto geometry = geometry_of(scene, boundary_of(scene));
  const int threads = threads_of(scene);
  SteadyFlow flow;
  Fields fields = fields_of(scene);
  paint(scene, geometry.get(), fields);
  flow.velocity_x = flow.velocity_y = CellField(patch);
  if (scene.model == Model::radial) flow.pressure = CellField(patch);
  RowSums fastest(patch.ny);
  parallel(threads, [&](Team& team) {
    const Rows rows = team.rows(patch.ny);
    for (int j = rows.begin; j < rows.end; ++j) {
      double most = 0;
      for (int i = 0; i < patch.nx; ++i) {
        const double share = fields.grains(i, j) * (geometry ? geometry->volume(i, j) : 1.0);
        if (share == 0) continue;
        const double x = patch.x_centre(i), y = patch.y_centre(j);
        const auto [u, v] = model.velocity(x, y);
        flow.velocity_x(i, j) = u;
        flow.velocity_y(i, j) = v;
        if (flow.pressure.allocated()) flow.pressure(i, j) = model.pressure(x, y);
        most = std::max(most, std::hypot(u, v));
      }
      fastest[j] = most;
    }
  });
  const double Q = discharge_of(scene), scale = discharge_scale(scene, total_width(scene));
  SeriesRow& row = flow.row;
  row.material_mass = masses_by_material(scene, fields, geometry.get(), threads);
  row.mass = row.material_mass[0];
  row.outflow = Q;
  for (const Orifice& o : scene.orifices)
    row.orifice_outflow.push_back(Q * images(scene, o) * discharge_scale(scene, o.width) /
                                  usual_discharge(scene));
  row.material_outflow = {Q};
  flow.grains = std::move(fields.grains);
  tell_slow(slow_shares(flow.grains, flow.derived("speed"), geometry.get(), flat_tops(scene),
                        slow_speeds(scene), threads),
            row);
  row.max_speed = row.step.max_speed = fastest.max();
  row.wall_seconds = seconds_since(start);
  Summary& summary = flow.summary;
  summary.reason =
      fmt::format("model {}: a steady field, not stepped", model_names[static_cast<int>(scene.model)]);
  summary.discharge_rate = Q;
  summary.discharge_constant = scale > 0 ? Q / scale : 0;
  static_cast<SlowGrains&>(summary) = row;
  summary.cells = patch.cells();
  summary.threads = threads;
  summary.wall_seconds = row.wall_seconds;
  summary.stages = {{"field", row.wall_seconds}};
  return flow;
}

CellField SteadyFlow::derived(const std::string& name) const {
  if (name == "grains") return grains;
  if (name == "velocity_x") return velocity_x;
  if (name == "velocity_y") return velocity_y;
  if (name == "pressure" && pressure.allocated()) return pressure;
  if (name != "speed") throw std::invalid_argument("this model has no field " + name);
  CellField speed(grains.patch());
  for (int j = 0; j < speed.ny(); ++j)
    for (int i = 0; i < speed.nx(); ++i) speed(i, j) = std::hypot(velocity_x(i, j), velocity_y(i, j));
  return speed;
}

}  // namespace hourglass
