#include "io/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/frame.hpp"
#include "kernels/strain_rate.hpp"
#include "solver/grain_properties.hpp"
#include "solver/steady_flow.hpp"

namespace hourglass {
namespace {

bool smooths(const Scene& scene) {
  return scene.rheology.smoothing_length > 0 && scene.rheology.law != Law::newtonian;
}

/// In which properties a material differs from the first.
std::string differences(const Scene& scene, int k) {
  const GrainProperties properties(scene);  // resolves what a module gives to each material
  const Material &first = scene.materials[0], &m = scene.materials[k];
  std::vector<std::string> names;
  const auto add = [&](bool differs, const char* name) {
    if (differs) names.push_back(name);
  };
  const auto differs = [&](GrainProperties::Property p) {
    return properties.by_material(p)[k] != properties.by_material(p)[0];
  };
  add(m.mu_s != first.mu_s, "mu_s");
  add(m.delta_mu != first.delta_mu, "delta_mu");
  add(m.I_0 != first.I_0, "I_0");
  add(m.diameter != first.diameter, "diameter");
  add(m.density != first.density, "density");
  add(m.cohesion != first.cohesion, "cohesion");
  add(scene.rheology.law == Law::newtonian && differs(GrainProperties::viscosity), "viscosity");
  add(scene.nonlocal && m.diameter == first.diameter && differs(GrainProperties::A_d), "A");
  add(scene.dilatancy && differs(GrainProperties::phi_g), "phi_g");
  add(scene.wall_friction && differs(GrainProperties::F), "F");
  return fmt::format("{}", fmt::join(names, ", "));
}

/// What is at hand against short waves, and whether the scene uses it.
std::string cures(const Scene& scene, const Material& m) {
  const Rheology& r = scene.rheology;
  const auto regularised = regularised_friction(m, r);
  const auto use = [](bool on) { return on ? "on" : "off"; };
  return fmt::format(
      "    against short waves: physics.rheology.smoothing_length {}, physics.rheology.cap: smooth {}, "
      "physics.nonlocal {},\n    physics.rheology.law: mu_I_regularised {}\n",
      r.smoothing_length > 0 ? fmt::format("on ({:.6g})", r.smoothing_length) : "off",
      use(r.cap == Cap::smooth), use(scene.nonlocal.has_value()),
      regularised ? fmt::format("off (has a solution here: I_1 = {:.3g})", regularised->I_1)
                  : "has no solution for this material");
}

std::string well_posedness(const Scene& scene, const Material& m) {
  if (m.mu_s == 0 && m.delta_mu == 0) return "no friction, nothing to be ill-posed\n";
  const auto range = well_posed_range(m);
  if (scene.rheology.law == Law::mu_I_regularised && range)
    return fmt::format(
        "mu(I) is well posed for {:.3g} <= I <= {:.3g}; law mu_I_regularised bends it below I_1 = {:.3g}, so "
        "that it is\n    there too; mu_inf = {:.6g} moves the upper end\n",
        (*range)[0], (*range)[1], (*range)[0], scene.rheology.mu_inf);
  if (!range)
    return fmt::format("ill-posed at every I (mu_s = {}, delta_mu = {})\n", m.mu_s, m.delta_mu) +
           cures(scene, m);
  const bool bounded = std::isfinite((*range)[1]);
  return (bounded ? fmt::format("well posed for {:.3g} <= I <= {:.3g}, ill-posed below and above\n",
                                (*range)[0], (*range)[1])
                  : fmt::format("well posed for I >= {:.3g}, ill-posed below\n", (*range)[0])) +
         cures(scene, m);
}

}  // namespace

Switches switches_of(const Scene& scene) {
  Switches s;
  const auto add = [&](bool on, std::string key, auto&& what) {
    if (on) {
      s.on.push_back({std::move(key), what()});
    } else if (!key.empty()) {
      s.off.push_back(std::move(key));
    }
  };
  add(scene.symmetry == Symmetry::mirror, "domain.symmetry", [] {
    return std::string("mirror: one half of the silo is solved; masses and rates are those of the whole");
  });
  add(scene.axisymmetric(), "domain.coordinates", [] {
    return std::string("axisymmetric around the left edge: cells and faces count by their radius (geometry)");
  });
  add(scene.air.model == AirModel::none, "air.model",
      [] { return std::string("none: p = 0 on the free surface, air is not solved"); });
  const char* solids = solid_model_names[static_cast<int>(scene.accuracy.solids)];
  add(!scene.inserts.empty(), "inserts",
      [&] { return fmt::format("solids in the flow: {}, by {} (geometry)", scene.inserts.size(), solids); });
  add(scene.hopper.has_value(), "hopper", [&] {
    return fmt::format(
        "walls at {:.6g} degrees to the vertical down to an outlet of {:.6g}, by {} (geometry)",
        scene.hopper->half_angle, scene.hopper->outlet, solids);
  });
  add(scene.feed.has_value(), "feed", [&] {
    return fmt::format("grains of {} replace air below y = {:.6g}",
                       scene.materials[scene.feed->material].name, scene.feed->level);
  });
  add(scene.start.has_value(), "start", [&] {
    return fmt::format("begins with {} at t = {:.6g}; fill is not read", scene.start->run,
                       scene.start->time.value_or(0));
  });
  const Rheology& r = scene.rheology;
  const bool friction = r.law != Law::newtonian;  // without it what follows is not used
  add(r.law != Law::mu_I, "physics.rheology.law", [&] {
    return r.law == Law::newtonian
               ? std::string("newtonian: eta is the material's viscosity; no shear rate is stored")
               : fmt::format("mu_I_regularised: mu(I) bent at small I, alpha = {}, mu_inf = {}", r.alpha,
                             r.mu_inf);
  });
  add(smooths(scene), "physics.rheology.smoothing_length", [&] {
    return fmt::format("{:.6g}: the shear rate is smoothed (passes at this cell size: {})",
                       r.smoothing_length, smoothing_passes(r.smoothing_length, scene.patch().h).size());
  });
  add(friction && r.cap == Cap::smooth, "physics.rheology.cap",
      [] { return std::string("smooth: friction meets eta_max without a kink"); });
  add(friction && r.background_pressure > 0, "physics.rheology.background_pressure",
      [&] { return fmt::format("{:.6g} is added to p in the law", r.background_pressure); });
  add(scene.nonlocal.has_value(), "physics.nonlocal", [&] {
    const Nonlocal& n = *scene.nonlocal;
    return fmt::format("granular fluidity spreads: A = {}, closure {}, walls {}; a solve of its own", n.A,
                       closure_names[static_cast<int>(n.closure)],
                       fluidity_wall_names[static_cast<int>(n.walls)]);
  });
  add(scene.dilatancy.has_value(), "physics.dilatancy", [&] {
    const Dilatancy& d = *scene.dilatancy;
    return fmt::format("packing phi(I) = max({} - {} I, {}), mode {}", d.phi_max, d.phi_g, d.phi_min,
                       dilatancy_mode_names[static_cast<int>(d.mode)]);
  });
  add(scene.wall_friction.has_value(), "physics.wall_friction", [&] {
    const WallFriction& f = *scene.wall_friction;
    return fmt::format("front and back wall: F = {:.6g}, mode {}", f.strength(),
                       friction_mode_names[static_cast<int>(f.mode)]);
  });
  bool cohesive = false;
  for (const Material& m : scene.materials) {
    if (m.cohesion == 0 || !friction) continue;
    cohesive = true;
    add(true, fmt::format("materials.{}.cohesion", m.name),
        [&] { return fmt::format("yield stress {:.6g} at P = 0", m.cohesion); });
  }
  add(false, cohesive ? "" : "cohesion", [] { return std::string(); });
  for (std::size_t k = 1; k < scene.materials.size(); ++k)
    add(true, fmt::format("materials.{}", scene.materials[k].name), [&] {
      const std::string in = differences(scene, static_cast<int>(k));
      const std::string& first = scene.materials[0].name;
      return in.empty() ? fmt::format("inert tracer: the same properties as {}", first)
                        : fmt::format("a tracer that differs from {} in {}", first, in);
    });
  add(false, scene.materials.size() > 1 ? "" : "tracers", [] { return std::string(); });
  const Splitting& split = scene.accuracy.splitting;
  add(split != Splitting{}, "accuracy.splitting", [&] {
    return fmt::format("{} x {} viscous solves and {} projections a step, rotational {}", split.outer,
                       split.picard, split.outer, split.rotational);
  });
  add(scene.accuracy.extrapolate > 0 && !scene.orifices.empty(), "accuracy.extrapolate", [&] {
    std::string grids;
    for (int k = scene.accuracy.extrapolate; k > 0; --k) {
      const Patch patch = coarser(scene, k).patch();
      grids += fmt::format("{} x {}{}", patch.nx, patch.ny, k > 1 ? ", " : "");
    }
    return fmt::format("runs on {} cells too, before this one, and extrapolates the discharge", grids);
  });
  add(scene.accuracy.vof == VofFlux::upwind, "accuracy.vof",
      [] { return std::string("upwind: what leaves a cell is mixed; no interface is reconstructed"); });
  add(scene.accuracy.precision == Precision::full, "accuracy.precision",
      [] { return std::string("full: the preconditioner in double, twice its memory"); });
  add(scene.accuracy.step_factor != 1, "accuracy.step_factor", [&] {
    return fmt::format("{} times time.dt_max", scene.accuracy.step_factor);
  });
  add(scene.accuracy.extra_sweeps > 0, "accuracy.extra_sweeps", [&] {
    return fmt::format("{} more sweeps on every level of a V-cycle", scene.accuracy.extra_sweeps);
  });
  add(scene.start_pressure == StartPressure::hydrostatic, "time.start_pressure",
      [] { return std::string("hydrostatic: one solve before the first step"); });
  return s;
}

std::string text_of(const Switches& s) {
  std::string text =
      "Always: grains and air by VOF, friction mu(I) unless a law replaces it, implicit viscous solve, "
      "projection.\n";
  std::size_t width = 0;
  for (const Switch& on : s.on) width = std::max(width, on.key.size());
  for (const Switch& on : s.on) text += fmt::format("  {:<{}}  {}\n", on.key, width, on.what);
  return text + fmt::format("Off, neither stored nor paid for: {}.\n", fmt::join(s.off, ", "));
}

std::string well_posedness_text(const Scene& scene) {
  if (scene.rheology.law == Law::newtonian) return "law newtonian: no friction, nothing to be ill-posed.\n";
  std::string text;
  for (const Material& m : scene.materials) text += fmt::format("  {}: {}", m.name, well_posedness(scene, m));
  return text;
}

std::string steady_text(const Scene& given) {
  Scene scene = given;
  resolve_model(scene);
  const auto form = [](OrificeForm f) {
    return f == OrificeForm::slot ? "as wide as they are" : "as points";
  };
  std::string text;
  double Q = 0;
  if (scene.model == Model::kinematic) {
    const Kinematic& k = *scene.kinematic;
    Q = *k.Q;
    text = fmt::format("Model kinematic: dv/dy = B d2v/dx2, u = -B dv/dx, B = {:.6g}, orifices {}\n", *k.B,
                       form(k.orifices));
  } else if (scene.model == Model::stochastic) {
    const Stochastic& k = *scene.stochastic;
    Q = *k.Q;
    text = fmt::format("Model stochastic: spots of L_s = {:.6g} drift and diffuse upwards, orifices {}{}\n",
                       *k.L_s, form(k.orifices),
                       k.spot > 0 ? fmt::format(", averaged over {:.6g} along x", k.spot) : "");
  } else {
    const Radial& r = *scene.radial;
    Q = *r.Q;
    const auto field = radial_field(radial_hopper(scene));
    const auto wall = field ? field->at(*r.half_angle * M_PI / 180) : RadialField::Point{};
    text = fmt::format(
        "Model radial: {} of half-angle {:.6g}, phi = {:.6g}, phi_w = {:.6g} degrees\n"
        "  stress q = {:.6g} on the axis, {:.6g} at the wall; speed at the wall {:.6g} of that on the axis\n",
        scene.axisymmetric() ? "cone" : "wedge", *r.half_angle, *r.phi, *r.phi_w,
        field ? field->q_axis() : NAN, wall.q, wall.f);
  }
  return text + fmt::format(
                    "  discharge Q = {:.6g}, which the model is given and does not predict\n"
                    "One steady field in closed form, one frame; nothing is stepped: {} cells, well under a "
                    "second, pictures apart.\n",
                    Q, scene.patch().cells());
}

std::vector<ArrayGroup> arrays_of(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const std::size_t tracers = scene.materials.size() - 1;
  const auto contents = [&](const std::string& group) -> std::string {
    if (group == "fields")
      return fmt::format("u, v, p, grains{}{}{}", tracers > 0 ? fmt::format(", tracers ({})", tracers) : "",
                         scene.dilatancy ? fmt::format(", solid ({})", tracers + 1) : "",
                         scene.nonlocal ? ", fluidity" : "");
    if (group == "backup") return "the fields again, to go back to in trouble";
    if (group == "geometry") return "open shares of cells, faces and control volumes, and their walls";
    if (group == "volume of fluid") return "fluxes of each phase, owner flags";
    if (group == "mass transport") return "density, mass fluxes";
    if (group == "rheology")
      return fmt::format("viscosity{}{}{}", scene.rheology.law == Law::newtonian ? "" : ", shear rate",
                         smooths(scene) ? ", smoothing" : "", scene.wall_friction ? ", wall force" : "");
    if (group == "momentum") return "u*, v*";
    if (group == "viscous solve") return "levels of multigrid, Krylov vectors";
    if (group == "projection") return "levels of multigrid, Krylov vectors, increment";
    if (group == "fluidity") return "levels of multigrid, Krylov vectors, source";
    if (group == "dilatancy")
      return scene.dilatancy->mode == DilatancyMode::weight ? "packing, fluxes at phi_max"
                                                            : "packing, fluxes at phi_max, divergence";
    if (group == "splitting") return "u*, v* without forces";
    return "";
  };
  std::vector<ArrayGroup> groups;
  for (const auto& [name, bytes] : simulation.memory()) groups.push_back({name, contents(name), bytes});
  return groups;
}

std::size_t total_bytes(const std::vector<ArrayGroup>& groups) {
  std::size_t total = 0;
  for (const ArrayGroup& g : groups) total += g.bytes;
  return total;
}

std::string memory_text(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const double cells = static_cast<double>(scene.patch().cells());
  std::string text = fmt::format("  {:<16} {:>14} {:>7}\n", "", "bytes", "a cell");
  const auto line = [&](const std::string& name, std::size_t bytes, const std::string& arrays) {
    text += fmt::format("  {:<16} {:>14} {:>7.1f}{}{}\n", name, bytes, static_cast<double>(bytes) / cells,
                        arrays.empty() ? "" : "  ", arrays);
  };
  const std::vector<ArrayGroup> groups = arrays_of(simulation);
  for (const ArrayGroup& g : groups) line(g.name, g.bytes, g.arrays);
  line("total", total_bytes(groups), "");
  const Output& o = scene.output;
  if (o.fields_every > 0 || o.snapshots_every > 0) {  // each field and the velocity in double
    const std::size_t fields = stored_fields(scene).size() + 2;
    line("a frame", fields * simulation.fields().p.bytes(),
         fmt::format("{} fields, while it is written or drawn", fields));
  }
  return text;
}

}  // namespace hourglass
