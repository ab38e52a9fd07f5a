#pragma once
// Every key of a scene file, once: the reader and the writer both walk this list.
#include <array>

#include "solver/scene.hpp"

namespace hourglass {

/// What the words of `accuracy` stand for. The Courant number is a matter of the scene, not of these.
inline constexpr std::array accuracy_names{"fast", "balanced", "accurate"};
inline constexpr std::array<Accuracy, 3> accuracy_presets{
    Accuracy{.viscous_tolerance = 5e-3,
             .pressure_tolerance = 1e-5,
             .fluidity_tolerance = 3e-2,
             .cells_across_orifice = 6},
    Accuracy{.viscous_tolerance = 1e-3,
             .pressure_tolerance = 3e-6,
             .fluidity_tolerance = 1e-2,
             .cells_across_orifice = 16},
    Accuracy{.viscous_tolerance = 1e-4,
             .pressure_tolerance = 1e-8,
             .fluidity_tolerance = 1e-3,
             .cells_across_orifice = 32,
             .extrapolate = 2},
};

/// Which keys place and size an insert depends on its shape.
template <class Visitor>
void visit_measures(Visitor& v, Insert& i) {
  if (i.shape == Shape::polygon) {
    v.points("points", i.points);
    v.foreign({"centre", "width", "height", "diameter"});
    return;
  }
  v.pair("centre", i.centre, "its middle, e.g. [75, 56.25]");
  if (i.shape == Shape::circle) {
    v.number(v.has("width") && !v.has("diameter") ? "width" : "diameter", i.width, "above 0");
    i.height = i.width;
    v.foreign({"width", "height", "points"});
    return;
  }
  v.number("width", i.width, "from its left to its right end, above 0");
  if (i.shape == Shape::square) i.height = i.width;
  if (i.shape != Shape::square || v.has("height"))
    v.number("height", i.height, "from its lower to its upper end, above 0");
  v.foreign({"diameter", "points"});
}

/// A key's `required` text says what the value is; without one the key has a default.
template <class Visitor>
void visit_scene(Visitor& v, Scene& s) {
  v.text("name", s.name);
  v.choice("units", s.units, units_names);
  const bool si =
      s.units == Units::SI;  // whose defaults would be metres and kilograms of nothing in particular
  v.map("domain", [&] {
    v.number("width", s.width, "the width of the domain, above 0");
    v.number("height", s.height, "the height of the domain, above 0");
    v.choice("symmetry", s.symmetry, symmetry_names);
    v.choice("coordinates", s.coordinates, coordinates_names);
  });
  v.map("grid", [&] { v.integer_or("auto", "cells_x", s.cells_x); });
  v.pair("gravity", s.gravity, si ? "in SI units, e.g. [0, -9.81]" : nullptr);
  v.choice("model", s.model, model_names);
  v.module("kinematic", s.kinematic, [&](Kinematic& k) {
    v.number("B", k.B);
    v.number("Q", k.Q);
    v.choice("orifices", k.orifices, orifice_form_names);
  });
  v.module("stochastic", s.stochastic, [&](Stochastic& k) {
    v.number("L_s", k.L_s);
    v.number("Q", k.Q);
    v.choice("orifices", k.orifices, orifice_form_names);
    v.number("spot", k.spot);
  });
  v.module("radial", s.radial, [&](Radial& r) {
    v.number("phi", r.phi);
    v.number("phi_w", r.phi_w);
    v.number("half_angle", r.half_angle);
    v.number("Q", r.Q);
    v.choice("wall_angle", r.wall_angle, wall_angle_names);
  });
  v.map("air", [&] {
    v.choice("model", s.air.model, air_model_names);
    v.number("density", s.air.density);
    v.number("viscosity", s.air.viscosity);
  });
  v.named("materials", s.materials, "at least one, e.g. sand: {mu_s: 0.62, delta_mu: 0.48, I_0: 0.6}",
          [&](Material& m) {
            v.number("mu_s", m.mu_s);
            v.number("delta_mu", m.delta_mu);
            v.number("I_0", m.I_0);
            v.number("diameter", m.diameter, si ? "in SI units, e.g. 1e-3" : nullptr);
            v.number("density", m.density, si ? "in SI units, e.g. 1500" : nullptr);
            v.number("cohesion", m.cohesion);
            v.number("viscosity", m.viscosity);
            v.number("A", m.A);
            v.number("phi_g", m.phi_g);
            v.number("F", m.F);
          });
  v.module("start", s.start, [&](Start& start) {
    v.text("run", start.run);
    v.number("time", start.time);
  });
  v.list("fill", s.fill,
         s.start
             ? nullptr
             : "what the domain holds at the start, e.g. - {material: sand, box: {x: [0, 150], y: [0, 135]}}",
         [&](Fill& f) {
           v.material("material", f.material, s.materials, "the name of a material, or air");
           v.shape(f.points);
         });
  if (s.left_is_middle()) s.walls[static_cast<int>(Side::left)] = Wall::free_slip;  // what a middle does
  v.map("walls", [&] {
    for (std::size_t side = 0; side < 4; ++side) v.choice(side_names[side], s.walls[side], wall_names);
  });
  v.list("orifices", s.orifices, nullptr, [&](Orifice& o) {
    v.choice("wall", o.wall, side_names);
    v.number("centre", o.centre, "its place along the wall");
    v.number("width", o.width, "its width, above 0");
  });
  v.list("inserts", s.inserts, nullptr, [&](Insert& i) {
    if (v.choice("shape", i.shape, shape_names, "a word, e.g. circle"))
      visit_measures(v, i);
    else
      v.skip({"centre", "width", "height", "diameter", "points"});
  });
  v.module("hopper", s.hopper, [&](Hopper& h) {
    v.number("half_angle", h.half_angle, "of the walls against the vertical, in degrees, e.g. 30");
    v.number("outlet", h.outlet, "the width of the outlet, above 0");
  });
  v.module("feed", s.feed, [&](Feed& f) {
    v.material("material", f.material, s.materials, "the name of a material");
    v.number("level", f.level, "the height up to which the domain is kept full, above 0");
  });
  v.map("physics", [&] {
    v.map("rheology", [&] {
      Rheology& r = s.rheology;
      v.choice("law", r.law, law_names);
      v.number("alpha", r.alpha);
      v.number("mu_inf", r.mu_inf);
      v.number("eta_min", r.eta_min);
      v.number("eta_max", r.eta_max);
      v.choice("cap", r.cap, cap_names);
      v.number("smoothing_length", r.smoothing_length);
      v.choice("corner_mean", r.corner_mean, corner_mean_names);
      v.choice("orifice_edge", r.orifice_edge, edge_rule_names);
      v.number("background_pressure", r.background_pressure);
    });
    v.module("nonlocal", s.nonlocal, [&](Nonlocal& n) {
      v.number("A", n.A);
      v.choice("closure", n.closure, closure_names);
      v.choice("walls", n.walls, fluidity_wall_names);
    });
    v.module("dilatancy", s.dilatancy, [&](Dilatancy& d) {
      v.number("phi_g", d.phi_g);
      v.number("phi_max", d.phi_max);
      v.number("phi_min", d.phi_min);
      v.choice("mode", d.mode, dilatancy_mode_names);
      v.number("relaxation_time", d.relaxation_time);
      v.number("K", d.K);
    });
    v.module("wall_friction", s.wall_friction, [&](WallFriction& f) {
      v.number("F", f.F);
      v.number("mu_w", f.mu_w);
      v.number("gap", f.gap);
      v.choice("mode", f.mode, friction_mode_names);
      v.number("speed_floor", f.speed_floor);
      v.pair("wall_velocity", f.wall_velocity);
    });
  });
  v.map("time", [&] {
    v.number("end", s.time.end);
    v.number("cfl", s.time.cfl);
    v.number("dt_max", s.time.dt_max);
    v.integer("max_steps", s.time.max_steps);
    v.choice("start_pressure", s.start_pressure, start_pressure_names);
  });
  v.map("stop", [&] {
    v.number("mass_below", s.stop.mass_below);
    v.number("steady_discharge", s.stop.steady_discharge);
  });
  int preset = -1;
  if (v.word("accuracy", preset, accuracy_names)) {
    if (preset >= 0) s.accuracy = accuracy_presets[preset];
  } else {
    v.map("accuracy", [&] {
      v.preset("preset", s.accuracy, accuracy_names, accuracy_presets);
      v.number("viscous_tolerance", s.accuracy.viscous_tolerance);
      v.number("pressure_tolerance", s.accuracy.pressure_tolerance);
      v.number("fluidity_tolerance", s.accuracy.fluidity_tolerance);
      v.integer("max_iterations", s.accuracy.max_iterations);
      v.integer("extra_sweeps", s.accuracy.extra_sweeps);
      v.integer("backup_every", s.accuracy.backup_every);
      v.choice("precision", s.accuracy.precision, precision_names);
      v.choice("solids", s.accuracy.solids, solid_model_names);
      v.choice("vof", s.accuracy.vof, vof_flux_names);
      v.number("step_factor", s.accuracy.step_factor);
      v.integer("cells_across_orifice", s.accuracy.cells_across_orifice);
      v.integer("extrapolate", s.accuracy.extrapolate);
      v.map("splitting", [&] {
        v.integer("outer", s.accuracy.splitting.outer);
        v.integer("picard", s.accuracy.splitting.picard);
        v.number("rotational", s.accuracy.splitting.rotational);
      });
    });
  }
  v.map("output", [&] {
    v.number("series_every", s.output.series_every);
    v.number("fields_every", s.output.fields_every);
    v.number("snapshots_every", s.output.snapshots_every);
    v.texts("fields", s.output.fields);
    v.integer("compression", s.output.compression);
  });
  v.integer("threads", s.threads);
}

}  // namespace hourglass
