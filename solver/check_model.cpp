// Models that are fields in closed form, in messages: what of a scene they cannot honour, and what they do
// not use.
#include <algorithm>

#include "solver/scene_checks.hpp"
#include "solver/scene_keys.hpp"
#include "solver/solids.hpp"
#include "solver/steady_flow.hpp"

namespace hourglass {
namespace {

constexpr double degree = M_PI / 180;

/// Things in the scene that would change the flow, and that the model knows nothing of.
void check_unable(const Scene& s, const std::string& model, Problems& p) {
  const auto cannot = [&](bool present, const std::string& path, const std::string& what) {
    if (present)
      p.error(path, fmt::format("model {} cannot have {}. Remove it, or use model mu_I.", model, what));
  };
  const bool radial = s.model == Model::radial;
  cannot(!s.inserts.empty(), "inserts", "solids in the flow");
  cannot(s.hopper && !radial, "hopper", "a hopper, only a flat floor (model radial has one)");
  cannot(s.feed.has_value(), "feed", "a feed: it is steady");
  cannot(s.start.has_value(), "start", "a stored run to start from: it is steady");
  cannot(s.nonlocal.has_value(), "physics.nonlocal", "granular fluidity");
  cannot(s.dilatancy.has_value(), "physics.dilatancy", "dilatancy");
  cannot(s.wall_friction.has_value(), "physics.wall_friction", "friction of a front and a back wall");
  cannot(s.materials.size() > 1, "materials", fmt::format("{} materials, only one", s.materials.size()));
  cannot(s.axisymmetric() && !radial, "domain.coordinates", "axisymmetric coordinates, only a plane silo");
  cannot(!(s.gravity[0] == 0 && s.gravity[1] < 0), "gravity", "gravity other than straight down");
  const Wall floor = s.wall(Side::bottom);
  cannot(floor == Wall::open, "walls.bottom", "an open floor, only orifices in it");
  if (s.orifices.empty())
    p.error("orifices",
            fmt::format("model {} needs an orifice in the floor (there is none). Add e.g. - {{wall: "
                        "bottom, centre: 75, width: 18.75}}.",
                        model));
  for (std::size_t k = 0; k < s.orifices.size(); ++k)
    cannot(s.orifices[k].wall != Side::bottom, fmt::format("orifices.{}.wall", k),
           "an orifice other than in the floor");
  if (!radial || s.orifices.empty()) return;
  cannot(s.orifices.size() > 1, "orifices",
         fmt::format("{} orifices: flow goes to one apex", s.orifices.size()));
  const Orifice& outlet = s.orifices.front();
  cannot(s.left_is_middle() && outlet.centre != 0, "orifices.0.centre", "an orifice off the middle");
  cannot(s.hopper && std::abs(s.hopper->outlet - outlet.width) > 1e-9 * outlet.width, "orifices.0.width",
         "an orifice narrower than the hopper's outlet");
}

/// Brings dimensional defaults to scale.
class ToScale : public KeyVisitor {
 public:
  explicit ToScale(const Scales& to) : scales_(to) {}
  void number(const char*, double& value, const Key& about) {
    if (about.multiple) value *= scales_.*about.multiple->scale;
  }
  void number(const char*, const std::optional<double>&, const Key&) {}

 private:
  Scales scales_;
};

/// Blocks that say something the model does not read; "" for none.
std::string unused(const Scene& s) {
  std::vector<std::string> names;
  const auto add = [&](bool differs, const char* name) {
    if (differs) names.push_back(name);
  };
  Scene defaults;
  ToScale to_scale(scales(s));
  visit_scene(to_scale, defaults);
  const Material &usual = defaults.materials.front(), &m = s.materials.front();
  add(s.air != defaults.air, "air");
  add(m.mu_s != usual.mu_s && s.model != Model::radial, "mu_s of the material");
  add(m.delta_mu != usual.delta_mu || m.I_0 != usual.I_0, "delta_mu and I_0 of the material");
  add(m.cohesion != 0, "cohesion of the material");
  add(s.rheology != defaults.rheology, "physics.rheology");
  add(s.time != defaults.time || s.start_pressure != defaults.start_pressure, "time");
  add(s.stop != defaults.stop, "stop");
  add(s.accuracy != defaults.accuracy, "accuracy");
  return fmt::format("{}", fmt::join(names, ", "));
}

void check_radial(const Scene& s, const Radial& r, Problems& p) {
  const Material& m = s.materials.front();
  const std::string friction = fmt::format("It is asin(mu_s) of the material, {}, by default.", m.mu_s);
  if (!p.is_sound("radial.phi") || !p.require(above(0).below(90), "radial.phi", *r.phi, friction)) return;
  bool sound = p.is_sound("radial.half_angle");
  sound &= p.require(*r.phi_w > 0 && *r.phi_w <= *r.phi, "radial.phi_w", *r.phi_w,
                     fmt::format("above 0, at most phi = {:.6g}", *r.phi), "Steel has about half of phi.");
  if (s.hopper && sound && *r.half_angle != s.hopper->half_angle) {
    p.error("radial.half_angle",
            fmt::format("{} is not that of the hopper, {}. Remove it.", *r.half_angle, s.hopper->half_angle));
    sound = false;
  }
  if (s.hopper && sound) {
    const double end = (s.width - outlet_of(s)[1]) / std::tan(s.hopper->half_angle * degree);
    double filled = 0;
    for (const Fill& fill : s.fill)
      for (const auto& corner : fill.points) filled = std::max(filled, fill.material >= 0 ? corner[1] : 0);
    if (end < filled * (1 - 1e-9))
      p.warn(
          "fill",
          fmt::format(
              "grains reach y = {:.6g}, but the hopper's walls end at {:.6g}: above, the radial field goes "
              "on as between such walls, which is not the flow between upright ones. Fill no higher, "
              "or read the field below.",
              filled, end));
  }
  if (!sound || radial_field(radial_hopper(s))) return;
  const double limit = mass_flow_limit(radial_hopper(s)) / degree;
  p.error(
      s.hopper ? "hopper.half_angle" : "radial.half_angle",
      fmt::format(
          "{:.6g} degrees is beyond the mass-flow limit, {:.1f} degrees for phi = {:.4g}, phi_w = {:.4g}: "
          "grains would not flow along such walls, and no radial field exists. Use a steeper hopper, a "
          "smaller phi_w, or model kinematic.",
          *r.half_angle, limit, *r.phi, *r.phi_w));
}

}  // namespace

void check_model(const Scene& given, Problems& p) {
  const auto idle = [&](Model model, bool named) {
    const char* name = model_names[static_cast<int>(model)];
    if (named && given.model != model)
      p.warn(name, fmt::format("is not used: the model is {}.", model_names[static_cast<int>(given.model)]));
  };
  idle(Model::kinematic, given.kinematic.has_value());
  idle(Model::stochastic, given.stochastic.has_value());
  idle(Model::radial, given.radial.has_value());
  if (given.model == Model::mu_I) return;

  const std::string model = model_names[static_cast<int>(given.model)];
  check_unable(given, model, p);
  if (given.materials.empty() || given.orifices.empty()) return;
  if (const std::string names = unused(given); !names.empty())
    p.warn("model", fmt::format("{} is a steady field in closed form: it does not use {}.", model, names));
  for (std::size_t k = 0; given.output.fields != Output{}.fields && k < given.output.fields.size(); ++k)
    for (const FieldInfo& field : known_fields())
      if (field.name == given.output.fields[k] && !has_field(given, field))
        p.warn(fmt::format("output.fields.{}", k), fmt::format("model {} has no {}.", model, field.name));
  const bool hopper_sound = p.is_sound("hopper") && p.is_sound("materials") && p.is_sound("orifices");
  if (given.model != Model::radial || !hopper_sound) return;
  Scene s = given;
  resolve_model(s);
  check_radial(s, *s.radial, p);
}

}  // namespace hourglass
