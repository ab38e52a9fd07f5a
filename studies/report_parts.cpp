#include "studies/report_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "io/chart_axes.hpp"
#include "io/files.hpp"
#include "io/offscreen.hpp"
#include "io/render.hpp"
#include "io/scales.hpp"
#include "io/xdmf.hpp"

namespace hourglass {
namespace fs = std::filesystem;
namespace {

/// `most` of n, evenly spaced, with both ends.
std::vector<int> picked(int n, int most) {
  if (n <= most) most = n;
  std::vector<int> out;
  for (int k = 0; k < most; ++k)
    out.push_back(most == 1 ? n - 1 : static_cast<int>(std::lround(double(k) * (n - 1) / (most - 1))));
  return out;
}

int share_of(int most, std::size_t fields) { return std::max(1, most / static_cast<int>(fields)); }

std::string time_text(double t, const Scene& scene) {
  return scene.model == Model::mu_I ? fmt::format("t = {} {}", number_text(t, 4), unit_text("T", scene.units))
                                    : "steady";
}

std::vector<Filmstrip> of_frames(const fs::path& run, const Scene& scene, int most, int halved) {
  const FieldReader reader(run);
  const int frames = static_cast<int>(reader.times().size());
  std::vector<std::string> fields;
  for (const std::string& name : frames > 0 ? reader.names(0) : fields)
    if (std::ranges::count(scene.output.fields, name) > 0) fields.push_back(name);
  std::ranges::sort(fields, {}, [&](const std::string& name) {
    return std::ranges::find(scene.output.fields, name) - scene.output.fields.begin();
  });
  std::vector<Filmstrip> strips;
  for (const std::string& field : fields) {
    const std::vector<int> shown = picked(frames, share_of(most, fields.size()));
    const auto picture = pictures_of(reader, field, shown);
    Filmstrip strip{field_info(field).label, {}, {}};
    for (const int frame : shown) {
      strip.captions.push_back(time_text(reader.times()[frame], scene));
      strip.pngs.push_back(png_of(picture(frame), halved));
    }
    strips.push_back(std::move(strip));
  }
  return strips;
}

std::vector<Filmstrip> of_snapshots(const fs::path& run, const Scene& scene, int most, int halved) {
  std::vector<Filmstrip> strips;
  for (const std::string& field : asked_fields(scene)) {
    int drawn = 0;
    while (fs::exists(snapshot_path(run, field, drawn))) ++drawn;
    if (drawn == 0) continue;
    Filmstrip strip{field_info(field).label, {}, {}};
    for (const int k : picked(drawn, share_of(most, asked_fields(scene).size()))) {
      strip.captions.push_back(fmt::format("picture {} of {}", k + 1, drawn));
      strip.pngs.push_back(smaller_png(snapshot_path(run, field, k), halved));
    }
    strips.push_back(std::move(strip));
  }
  return strips;
}

}  // namespace

std::string status_html(Ending ending, const std::string& status, const std::string& reason) {
  constexpr const char* look[] = {"good", "bad", "wait"};
  return fmt::format("<p class=\"status {}\"><b>{}</b> <span>{}</span></p>\n", look[static_cast<int>(ending)],
                     html_text(status), html_text(reason));
}

std::string spaced(std::string words) {
  std::ranges::replace(words, '_', ' ');
  return words;
}

std::string value_text(double value, std::optional<double> error) {
  if (!std::isfinite(value)) return "–";
  if (!error || !(*error > 0) || !std::isfinite(*error)) return number_text(value, 4);
  const int decimals = std::max(0, 1 - static_cast<int>(std::floor(std::log10(*error))));
  return decimals > 6 ? fmt::format("{} ± {}", number_text(value, 6), number_text(*error, 2))
                      : fmt::format("{:.{}f} ± {:.{}f}", value, decimals, *error, decimals);
}

std::string cards_html(const std::vector<Card>& cards) {
  std::string out = "<dl class=\"cards\">\n";
  for (const Card& card : cards)
    out += fmt::format("<div><dt>{}</dt><dd>{} <small>{}</small></dd></div>\n", html_text(card.name),
                       html_text(card.value), html_text(card.unit));
  return out + "</dl>\n";
}

std::string charts_html(const std::vector<Chart>& charts) {
  std::string out;
  for (const Chart& chart : charts) {
    const auto [x, y] = scales_of(chart);
    const bool empty = std::ranges::none_of(chart.series, [&x = x, &y = y](const Series& s) {
      for (std::size_t k = 0; k < s.x.size(); ++k)
        if (x.can_show(s.x[k]) && y.can_show(s.y[k])) return true;
      return false;
    });
    if (!empty) out += svg_figure(chart);
  }
  return out.empty() ? out : "<div class=\"charts\">\n" + out + "</div>\n";
}

SummaryFile::SummaryFile(const fs::path& run) {
  if (const std::string text = text_at(run / "summary.json"); !text.empty())
    root_ = parse_yaml(text);  // JSON is YAML
}
const YamlNode* SummaryFile::node(const std::string& key) const { return root_.find(key); }
std::string SummaryFile::text(const std::string& key) const {
  const YamlNode* found = node(key);
  return found && found->kind == YamlNode::Kind::scalar ? found->text : "";
}
std::optional<double> SummaryFile::number(const std::string& key) const {
  const std::string found = text(key);
  char* end = nullptr;
  const double value = std::strtod(found.c_str(), &end);
  return end == found.c_str() ? std::nullopt : std::optional(value);
}

std::string provenance_html(const SummaryFile& summary) {
  const YamlNode* made = summary.node("provenance");
  if (!made) return "<p>Not known: there is no summary.</p>\n";
  std::vector<std::pair<std::string, std::string>> rows;
  for (const auto& [key, value] : made->keys) rows.emplace_back(spaced(key), value.text);
  return html_pairs(rows);
}

std::string again_html(const SummaryFile& summary, const std::string& command, const std::string& file,
                       const std::string& text) {
  const YamlNode* made = summary.node("provenance");
  const YamlNode* revision = made ? made->find("revision") : nullptr;
  std::string commands;
  std::string words;
  if (revision && revision->text != "unknown") {
    const bool dirty = revision->text.ends_with("-dirty");
    commands = fmt::format("git checkout {}\n", revision->text.substr(0, revision->text.find('-')));
    if (dirty) words = "The program had changes that were not committed: the same numbers are not certain. ";
  }
  commands += "./hourglass " + command + '\n';
  return fmt::format(
      "<p>{}Save <a download=\"{}\" href=\"data:text/plain;charset=utf-8;base64,{}\">{}</a>, then:</p>\n"
      "<div><pre>{}</pre><button type=\"button\" class=\"copy\">Copy</button></div>\n"
      "<details><summary>{}</summary><div><pre>{}</pre><button type=\"button\" class=\"copy\">Copy</button>"
      "</div></details>\n",
      words, html_text(file), base64(text), html_text(file), html_text(commands), html_text(file),
      html_text(text));
}

std::vector<Filmstrip> filmstrips(const fs::path& run, const Scene& scene, int most, int halved) {
  if (fs::exists(run / "fields.h5")) try {
      if (auto strips = of_frames(run, scene, most, halved); !strips.empty()) return strips;
    } catch (const NoGraphics&) {  // what the run drew itself is left
    }
  return of_snapshots(run, scene, most, halved);
}

}  // namespace hourglass
